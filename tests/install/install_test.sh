#!/usr/bin/env bash
# Installs Scree into an empty folder and uses it from there as its users do: a program of somebody else that finds it
# with CMake, the manual pages, and the Debian package, unpacked and run.
#   install_test.sh BUILD OUTSIDE WORK     BUILD: built tree, OUTSIDE: the other program's source, WORK: scratch, emptied
set -euo pipefail
build=$1 outside=$2 work=$3
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 PRTE_ALLOW_RUN_AS_ROOT=1 PRTE_ALLOW_RUN_AS_ROOT_CONFIRM=1
rm -rf "$work"; mkdir -p "$work"; cd "$work"
fail() { echo "install_test: $1" >&2; exit 1; }

# 1. installed, moved, found: nothing may hold the path that it was installed to
cmake --install "$build" --prefix "$work/first" >install.log
mv first prefix
! grep -rl "$build" prefix/lib/*/cmake prefix/lib/cmake 2>/dev/null || fail "an installed CMake file names the build folder"
cmake -S "$outside" -B outside -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" >outside.log 2>&1 || { cat outside.log; fail "find_package"; }
cmake --build outside >>outside.log 2>&1 || { cat outside.log; fail "the outside program does not build"; }
prefix/bin/scree-mesher generate box --size "1, 2, 3" -o box.shape.h5 >/dev/null
expected=$'box 6 22\ndistance 3'
[[ "$(outside/outside box.shape.h5)" == "$expected" ]] || fail "the outside program said: $(outside/outside box.shape.h5)"

# the engine, by programs that have its headers and its library alone: the hash of the solver, and errors as they are told
cat >fall.toml <<'CASE'
gravity = [0, 0, -9.81]
[time]
duration = "60 ms"
[materials.glass]
density = 2500
[[pairs]]
between = ["glass", "glass"]
stiffness = "1 kN/m"
restitution = 0.7
friction = 0.4
[shapes.ball]
sphere = { radius = "2 mm" }
[[bodies]]
shape = "ball"
material = "glass"
position = [0, 0, 0.03]
[[bodies]]
shape = "ball"
material = "glass"
position = [0.001, 0, 0.004]
[[walls]]
name = "floor"
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "glass"
[output]
every = "10 ms"
CASE
prefix/bin/scree-decomposer pack fall.toml -o fall.scene.h5 >pack.log 2>&1 || { cat pack.log; fail "pack"; }
prefix/bin/scree-solver fall.scene.h5 -o fall.run >/dev/null 2>&1
hash=$(/usr/bin/python3 - <<'PYTHON'
import csv
rows = [row for row in csv.reader(line for line in open("fall.run/log.csv") if not line.startswith("#"))]
column = [name.split(" ")[0] for name in rows[0]].index("state_hash")
print(rows[-1][column])
PYTHON
)
outside/step_in_c fall.scene.h5 >c.txt
outside/step_in_cpp fall.scene.h5 >cpp.txt
grep -q "^$hash " c.txt || fail "the engine in C: $(cat c.txt); the solver has $hash"
grep -q "^101 calls, as it should fall, held back$" c.txt || fail "a force in C: $(cat c.txt)"
grep -q "^$hash " cpp.txt || fail "the engine in C++: $(cat cpp.txt); the solver has $hash"
grep -q "^2 set_wrench: no body of the run has the id 987654" cpp.txt || fail "an unknown body in C++: $(cat cpp.txt)"
grep -q "^my own mistake$" cpp.txt || fail "an exception in C++: $(cat cpp.txt)"
if command -v gfortran >/dev/null; then
  library=$(dirname "$(find prefix -name libscree_engine.so)")
  gfortran -Wall -std=f2008 "$outside/step.f90" -o outside/step_in_fortran -L"$library" -lscree_engine -Wl,-rpath,"$work/$library"
  [[ "$(outside/step_in_fortran fall.scene.h5)" == "$hash" ]] || fail "the engine in Fortran: $(outside/step_in_fortran fall.scene.h5); the solver has $hash"
fi

# 2. the tools and nothing else; every tool has its page and its completion
[[ "$(cd prefix/bin && echo *)" == "scree-decomposer scree-mesher scree-post scree-solver" ]] || fail "installed are: $(cd prefix/bin && echo *)"
for tool in mesher decomposer solver post; do
  grep -q "SH EXAMPLES" "prefix/share/man/man1/scree-$tool.1" || fail "no manual page of scree-$tool"
  bash -n "prefix/share/bash-completion/completions/scree-$tool" || fail "the completion of scree-$tool is no shell"
done

# 3. the Debian package
(cd "$build" && cpack -G DEB -B "$work/package" >"$work/cpack.log" 2>&1) || { cat cpack.log; fail "cpack"; }
dpkg -x package/scree_*.deb unpacked
mpi=$(dpkg-query -S '*/libmpi.so.40' | sed -n '1s/:.*//p')  # libopenmpi3 of Debian 12, libopenmpi40 of Debian 13
[[ -n $mpi ]] || fail "no package has libmpi.so.40"
for library in "$mpi" libhdf5-openmpi python3-h5py python3-numpy; do
  dpkg -f package/scree_*.deb Depends | grep -q "$library" || fail "the package does not depend on $library"
done
unpacked/usr/bin/scree-mesher info box.shape.h5 >info.txt
grep -q "box" info.txt || fail "the packaged mesher said: $(cat info.txt)"
unpacked/usr/bin/scree-solver --version >/dev/null

# 4. the Python package, with the tools beside it and the schema inside it
for root in prefix unpacked/usr; do
  env -u SCREE_BIN PATH=/usr/bin:/bin PYTHONPATH="$root/lib/python3/dist-packages" /usr/bin/python3 -B - "$root" >python.txt <<'PYTHON' || fail "the Python package in $root"
import os, sys, scree
assert os.path.abspath(scree.__file__).startswith(os.path.abspath(sys.argv[1])), scree.__file__
assert scree.Case.from_text("[time]\nduraton = 1\n").problems()
print(scree.call("mesher", "info", "box.shape.h5", progress=False).command[0])
print(scree.open_shapes("box.shape.h5")["box"].volume)
PYTHON
  [[ "$(head -n 1 python.txt)" -ef "$root/bin/scree-mesher" ]] || fail "the Python package of $root calls $(head -n 1 python.txt)"
done
