#!/usr/bin/env bash
# Fuzzes our own mesh reader, check and repair with libFuzzer and AddressSanitizer. Needs clang-14 (./setup --developer).
#
#   tests/fuzz/run.sh BUILD SECONDS [folder of the corpus]
#
# BUILD is a finished build: what is not under test is linked from its libraries. Ends with 0 when nothing was found.
set -euo pipefail
build=$(cd "$1" && pwd); seconds=$2; corpus=${3:-$build/fuzz}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
mkdir -p "$corpus"
sources=(tests/fuzz/fuzz_meshes.cpp mesher/bmf_reader.cpp mesher/mesh_repair.cpp mesher/mesh_check.cpp mesher/heal_mesh.cpp
  mesher/fill_holes.cpp mesher/self_intersections.cpp core/geometry/triangle_mesh.cpp core/geometry/mass_properties.cpp)
flags=(-std=c++20 -O1 -g -fsanitize=fuzzer,address,undefined -fno-sanitize=vptr -I"$root" -I"$build/generated" -I/usr/include/eigen3)
cd "$root"
clang++-14 "${flags[@]}" "${sources[@]}" -o "$build/fuzz_meshes" "$build"/mesher/libscree_mesher_lib.a \
  "$build"/core/distance/libscree_distance.a "$build"/core/geometry/libscree_geometry.a "$build"/core/base/libscree_base.a \
  -lhwy -lfmt -lcrypto $(mpicxx --showme:link) -L/usr/lib/x86_64-linux-gnu/hdf5/openmpi -lhdf5
# seeds: a small body of openuniverse, and a tetrahedron in the other spelling
[[ -f /usr/share/openuniverse/3dmodels/deimos.bmf ]] && { printf '\0'; cat /usr/share/openuniverse/3dmodels/deimos.bmf; } > "$corpus/seed_bmf"
printf '\1\0\0\1\5\31\0\2\1\0\1\3\1\2\3\0\3\2' > "$corpus/seed_mesh"
cd "$corpus"
"$build/fuzz_meshes" -max_total_time="$seconds" -max_len=4096 -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 "$corpus"
