#!/usr/bin/env bash
# Draws the pictures of docs/guide/gallery_benches.md. Usage: tools/pictures/draw_gallery_benches.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "$0")/../.."
program=${1:-build/straytrace}
pages=docs/guide/gallery_
"$program" render examples/benches/rb1.yaml -o ${pages}rb1.png --eye=-0.25m,-0.35m,0.42m --look 0.4m,0.26m,0.06m --up 0,0,1 \
  --fov 40deg --pixels 700x460 --beams
"$program" render examples/virgo_arm.yaml -o ${pages}flash_arm.png --from ITM --fov 0.05deg --flash --lamp 5cm \
  --pixels 600x450
"$program" render examples/bench.yaml -o ${pages}flash_bench.png --eye 0,0,8cm --look 2cm,0,60cm --fov 50deg --flash \
  --lamp 3mm --pixels 600x450
folder=$(mktemp -d)
"$program" run examples/benches/recoupled_2019.yaml -o "$folder/run" --quiet > /dev/null
cp "$folder/run/report.png" ${pages}recoupled_2019.png
"$program" trace examples/benches/michelson.yaml -o "$folder/rings.h5" --quiet > /dev/null
"$program" maps "$folder/rings.h5" -o "$folder/rings" > /dev/null
cp "$folder/rings/rings.png" ${pages}rings.png
"$program" ghosts examples/benches/pick_off.yaml --order 2 -o "$folder/ghosts" --quiet > /dev/null
cp "$folder/ghosts/ghosts.png" ${pages}pick_off.png
rm -r "$folder"
