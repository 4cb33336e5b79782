#!/usr/bin/env bash
# Every C++ file of the repository is as clang-format 14 would write it. usage: format_test.sh ROOT    Exit 77: skipped.
set -euo pipefail
cd "$1"
format=$(command -v clang-format-14) || { echo "SKIPPED: clang-format-14 is missing: run ./setup"; exit 77; }
mapfile -t files < <(find core mesher decomposer solver post tests -name '*.cpp' -o -name '*.hpp' | sort)
[[ ${#files[@]} -gt 100 ]] || { echo "FAILED: only ${#files[@]} files found"; exit 1; }
"$format" --dry-run -Werror "${files[@]}" || { echo "FAILED: run clang-format-14 -i on the files above"; exit 1; }
echo "${#files[@]} files are formatted"
