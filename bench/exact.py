#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Diffuse walks in tubes, a bench and a mesh with every hit checked: in the tubes by 80-bit arithmetic, elsewhere by a second tree over
the same surfaces in reverse order and, one hit in 100,000, by a test of every surface. Fails where a hit is wrong or lost, or a ray
hits the surface that it leaves.

Examples:
  scripts/bench exact                 1e8 bounces in each scene: six minutes of one core
  scripts/bench exact 1e9 --keep      an hour; the page shows the counts
"""
import json
import subprocess
import sys

from record import BUILD, Results, arguments

CHECKED = {"tube3": "80-bit arithmetic", "tube40": "80-bit arithmetic", "bench": "second tree, all surfaces",
           "mesh": "second tree, all triangles"}


def main():
    parser = arguments(__doc__)
    parser.add_argument("bounces", nargs="?", type=float, default=1e8, help="in each scene (1e8)")
    words = parser.parse_args()
    bounces = 1e5 if words.quick else words.bounces
    bad = 0
    with Results("exact", words, on_any=True) as results, \
            subprocess.Popen([BUILD / "bench_exact", f"{bounces:.0f}"], stdout=subprocess.PIPE, text=True) as process:
        for said in map(json.loads, process.stdout):
            bad += said["wrong"] + said["lost"] + said["self"]
            results.add(said["name"], bounces=said["bounces"], wrong=said["wrong"], lost=said["lost"], itself=said["self"],
                        checked_by=CHECKED[said["name"]], goal={"of": "wrong", "at_most": 0, "name": f"wrong hits in {said['name']}"})
    return 1 if bad or process.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
