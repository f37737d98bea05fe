#!/usr/bin/env bash
# Builds examples/library against an installed package and compares its numbers with those of the command.
# Usage: try_library.bash PREFIX, where examples/ and the command are; needs g++, cmake and make.
set -euo pipefail
cmake -S examples/library -B mine "-DCMAKE_PREFIX_PATH=$1" >/dev/null
cmake --build mine >/dev/null
mine/baffle_reflectance examples/virgo_arm.yaml 16384 >mine.txt 2>/dev/null
straytrace trace examples/virgo_arm.yaml -o mine.h5 --histories 16384 --quiet >/dev/null
for factor in x1 x0.1; do
  told=$(sed -n "s/^baffle=$factor  h(10 Hz) = \([^ ]*\) .*/\1/p" mine.txt)
  straytrace noise mine.h5 --set "baffle=$factor" --format json --quiet >mine.json
  wanted=$(awk '/"total_strain"/ { in_total = 1 }
    in_total && /"value"/ { gsub(/[^-0-9.e]/, "", $2); value = $2 }
    in_total && /"frequency_Hz": 10.0/ { printf "%.9g", value; exit }' mine.json)
  [[ -n $told && $told == "$wanted" ]] || { echo "baffle=$factor: the library gives '$told', the command '$wanted'"; exit 1; }
  echo "library: h(10 Hz) = $told of the command with baffle=$factor"
done
