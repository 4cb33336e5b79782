#!/usr/bin/env bash
# Fuzzes our own mesh readers, check and repair with libFuzzer and AddressSanitizer. Needs clang-14 (./setup --developer).
#
#   tests/fuzz/run.sh BUILD RUNS [folder of the corpus]
#
# BUILD is a finished build: what is not under test is linked from its libraries. Begins with tests/fuzz/corpus; inputs that reach new
# code are added to the other folder, BUILD/fuzz unless named. Ends with 0 when nothing was found.
# To renew tests/fuzz/corpus: BUILD/fuzz_meshes -merge=1 tests/fuzz/corpus BUILD/fuzz
set -euo pipefail
build=$(cd "$1" && pwd); runs=$2; corpus=${3:-$build/fuzz}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
mkdir -p "$corpus"; corpus=$(cd "$corpus" && pwd)
sources=(tests/fuzz/fuzz_meshes.cpp mesher/io/bmf_reader.cpp mesher/io/off_reader.cpp mesher/io/ply_reader.cpp mesher/io/stl_reader.cpp
  mesher/io/obj_reader.cpp mesher/io/text_reader.cpp mesher/io/polygons.cpp mesher/io/mesh_file.cpp mesher/repair/mesh_repair.cpp mesher/check/mesh_check.cpp mesher/repair/heal_mesh.cpp
  mesher/repair/fill_holes.cpp mesher/check/self_intersections.cpp core/geometry/triangle_mesh.cpp core/geometry/mass_properties.cpp)
# coverage of branches alone: operands of comparisons cost a third of the time
flags=(-std=c++20 -O2 -g -fsanitize=fuzzer,address,undefined -fno-sanitize=vptr -fno-sanitize-coverage=trace-cmp -I"$root" -I"$build/generated" -I/usr/include/eigen3)
cd "$root"
clang++-14 "${flags[@]}" "${sources[@]}" -o "$build/fuzz_meshes" "$build"/mesher/libscree_mesher_lib.a \
  "$build"/core/distance/libscree_distance.a "$build"/core/geometry/libscree_geometry.a "$build"/core/base/libscree_base.a \
  -lhwy -lfmt -lcrypto $(mpicxx --showme:link) -L/usr/lib/x86_64-linux-gnu/hdf5/openmpi -lhdf5
[[ "$runs" == 0 ]] && exit 0  # built only
cd "$corpus"  # what is found is written here
# the entropic schedule would take five times as long as the runs themselves
ASAN_OPTIONS=malloc_context_size=3 "$build/fuzz_meshes" -runs="$runs" -entropic=0 -max_len=256 -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 "$corpus" "$root/tests/fuzz/corpus"
