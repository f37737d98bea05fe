#!/usr/bin/env bash
# Fails when a C++ file of src/, step/, tests/ or fuzz/ is not formatted by .clang-format. Version 14, because other versions of
# clang-format disagree with it. With --fix: rewrites the files.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
tool=$(command -v clang-format-14 || command -v clang-format || true)
if [[ -z $tool ]]; then
  echo "clang-format 14 is not installed (scripts/setup --test installs it)" >&2
  exit 1
fi
if [[ "$("$tool" --version)" != *" 14."* ]]; then
  echo "$tool is not version 14 (scripts/setup --test installs clang-format-14)" >&2
  exit 1
fi

mapfile -t files < <(find src step tests fuzz -name '*.cpp' -o -name '*.hpp' | sort)
if ((${#files[@]} == 0)); then
  echo "no C++ files found in $PWD/src, step and tests" >&2
  exit 1
fi
if [[ "${1:-}" == --fix ]]; then
  "$tool" -i "${files[@]}"
else
  "$tool" --dry-run --Werror "${files[@]}"
  echo "${#files[@]} files are formatted"
fi
