#!/usr/bin/env bash
# Draws the pictures that commands of the pages write: guides, CAD, maps, measured files. Usage: tools/pictures/draw_guides.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "$0")/../.."
program=$(realpath "${1:-build/straytrace}")
pages=$PWD/docs
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cp -r examples python "$folder"
cd "$folder"
"$program" run examples/virgo_arm.yaml -o demo --quiet > /dev/null
cp demo/report.png "$pages/guide/virgo_arm.png"
"$program" scan examples/pipe.yaml aperture=74cm..86cm:4 pipe=90cm,110cm -p baffles=50 --margin 1/300 -o pipe/ --quiet > /dev/null
cp pipe/scan.png "$pages/guide/pipe.png"
sed 's/^ghosts: .*/ghosts: off/' examples/end_bench.yaml > examples/night.yaml
"$program" trace examples/night.yaml -o bench.h5 --quiet > /dev/null
"$program" project bench.h5 --motion examples/bench_storm.yaml --gps 2020-01-12T03:12:00 --duration 48s --seed 4 -o h.hdf5 \
  --save-motion storm.hdf5 > /dev/null
"$program" fringes bench.h5 --body bench --axis z --channel "storm.hdf5::bench z" --overlay h.hdf5::h --show 1 \
  -o "$pages/guide/arch.png" > /dev/null
"$program" signal psd examples/data/bump_quiet.hdf5::H --segment "8 s" --band "5 Hz..120 Hz" -o "$pages/guide/bump.png" > /dev/null
"$program" inspect examples/data/cad_bench.step --plot "$pages/reference/cad_bench.png" > /dev/null
"$program" inspect examples/data/dump_bsdf.csv --plot "$pages/reference/scatter/measured_files.png" > /dev/null
PYTHONPATH=python /usr/bin/python3 -m straytrace.maps examples/data/mirror_map.dat -o mirror_psd.csv --aperture "18 cm" \
  --remove curvature --plot "$pages/reference/maps.png" > /dev/null
