#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Instructions of fixed kernels, counted by callgrind and compared with those in bench/results/instructions.jsonl: an alarm that
other work on the machine does not touch. Portable kernels, so that the processor does not matter.

A count may grow by 3 %, and by 15 % where compiler or C library are not those of the stored counts.

Examples:
  scripts/bench instructions          count and compare; fails where a count grew
  scripts/bench instructions --keep   these are the counts from now on: when a growth has a reason
"""
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

from record import BUILD, KEPT, Results, arguments, machine

GROWTH, GROWTH_ELSEWHERE = 0.03, 0.15
COUNTED = re.compile(r"^\s*([\d,]+).*:counted_(\w+)", re.MULTILINE)
STORED = KEPT / "instructions.jsonl"


def counts(program, twice=""):
    """{kernel: instructions per item}; the kernel `twice` does its work two times."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "callgrind.out"
        items = subprocess.run(["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={file}", "--toggle-collect=counted_*",
                                str(program), twice], env=dict(os.environ, STRAYTRACE_ISA="portable"), capture_output=True, text=True)
        if items.returncode != 0:
            sys.exit(f"{program} under valgrind: ends with {items.returncode}\n{items.stdout}{items.stderr}")
        table = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", str(file)], capture_output=True, text=True,
                               check=True).stdout
    of = dict(line.split() for line in items.stdout.splitlines())
    found = {kernel: int(count.replace(",", "")) for count, kernel in COUNTED.findall(table)}
    if found.keys() != of.keys():
        sys.exit(f"callgrind found {sorted(found)}, not {sorted(of)}")
    return {kernel: found[kernel] / int(of[kernel]) for kernel in of}


def made_with(folder):
    return {"compiler": machine(folder)["compiler"], "library": " ".join(platform.libc_ver()), "flags": machine(folder)["flags"]}


def stored(file=STORED):
    """({kernel: instructions per item}, what they were made with)."""
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return {line["case"]: line["ours"] for line in lines}, {key: lines[0][key] for key in ("compiler", "library", "flags")}


def grown(now, made, before, made_before):
    """(kernels that grew too much or are not stored, notes)."""
    same = made == made_before
    limit = GROWTH if same else GROWTH_ELSEWHERE
    notes = [] if same else [f"stored counts are of {made_before}, these of {made}: {100 * limit:.0f} % may be lost"]
    found = []
    for kernel in sorted(now.keys() | before.keys()):
        if kernel not in now or kernel not in before:
            found.append(f"{kernel}: {'not stored' if kernel in now else 'stored, but not counted'}")
            continue
        change = now[kernel] / before[kernel] - 1
        said = f"{kernel}: {before[kernel]:.1f} instructions were stored, now {now[kernel]:.1f} ({100 * change:+.1f} %)"
        if change > limit:
            found.append(said)
        elif change < -limit:
            notes.append(said)
    return found, notes


def main():
    parser = arguments(__doc__)
    words = parser.parse_args()
    program = BUILD / "bench_instructions"
    now, made = counts(program), made_with(BUILD)
    if words.keep or not STORED.exists():
        words.keep = True
        with Results("instructions", words, on_any=True) as results:
            for kernel, count in now.items():
                results.add(kernel, ours=count, unit="instructions", library=made["library"])
        return 0
    found, notes = grown(now, made, *stored())
    print("\n".join(found + notes) or f"{len(now)} kernels take as many instructions as before")
    if found:
        print("find out why; if it must be so: scripts/bench instructions --keep")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
