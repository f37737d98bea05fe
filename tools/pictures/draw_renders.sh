#!/usr/bin/env bash
# Draws the pictures of docs/reference/render.md and docs/reference/ghosts.md. Usage: tools/pictures/draw_renders.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "$0")/../.."
program=${1:-build/straytrace}
pages=docs/reference
"$program" render examples/bench.yaml -o $pages/render_bench.png --eye=-35cm,50cm,5cm --look 12cm,-3cm,58cm \
  --fov 34deg --pixels 660x440 --beams
"$program" render examples/virgo_arm.yaml -o $pages/render_importance.png --mode importance --pixels 900x300
folder=$(mktemp -d)
"$program" wave examples/new_arm.yaml --order 0 --quiet -o "$folder/field.h5" > /dev/null
"$program" render "$folder/field.h5" -o $pages/render_halo.png --mode halo --from ITM --fov 0.03deg --pixels 660x440
"$program" ghosts examples/bench.yaml --order 2 --show 38 -o "$folder" > /dev/null
cp "$folder/ghosts.png" $pages/ghosts_bench.png
rm -r "$folder"
