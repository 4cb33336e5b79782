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

# 2. the tools and nothing else; every tool has its page and its completion
[[ "$(cd prefix/bin && echo *)" == "scree-decomposer scree-mesher scree-post scree-solver" ]] || fail "installed are: $(cd prefix/bin && echo *)"
for tool in mesher decomposer solver post; do
  grep -q "SH EXAMPLES" "prefix/share/man/man1/scree-$tool.1" || fail "no manual page of scree-$tool"
  bash -n "prefix/share/bash-completion/completions/scree-$tool" || fail "the completion of scree-$tool is no shell"
done

# 3. the Debian package
(cd "$build" && cpack -G DEB -B "$work/package" >"$work/cpack.log" 2>&1) || { cat cpack.log; fail "cpack"; }
dpkg -x package/scree_*.deb unpacked
for library in libopenmpi3 libhdf5-openmpi python3-h5py python3-numpy; do
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
