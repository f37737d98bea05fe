#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measure what headers cost the build: Clang parses the batches of src/ and reports the time in each header (-ftime-trace).

Usage: header_cost.py [BUILD] [--batches N] [--headers N] [--module NAME]

Prints Markdown tables for docs/develop/performance.md: the batches with the longest front end, the libraries, and our headers.
The time of a header excludes the headers that it includes. Times are processor times of the front end, without optimisation.
Needs clang++ (scripts/setup --fuzz) and a configured build (scripts/build).

Example:
  python3 tools/header_cost.py build
"""
import argparse
import collections
import json
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
OF_GCC = re.compile(r"-W\S*|-O\d|--param=ggc\S*")        # warnings that Clang does not have, optimisation, memory of g++
LIBRARIES = (("/fmt/", "fmt"), ("/nlohmann/", "nlohmann_json"), ("/eigen3/", "Eigen"), ("/CLI/", "CLI11"), ("/yaml-cpp/", "yaml-cpp"),
             ("/boost/", "Boost"), ("hdf5", "HDF5"), ("/H5", "HDF5"), ("Random123", "Random123"), ("/assimp/", "assimp"))
STANDARD = "C++ and C standard library"


def trace_of(entry, folder):
    """Events of Clang for one batch, and its processor time."""
    words = [word for word in shlex.split(entry["command"])[1:] if not OF_GCC.fullmatch(word)]
    words = words[:words.index("-o")] + words[words.index("-c") + 1:]
    trace = folder / "batch.json"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(["clang++", *words, "-w", "-O0", "-emit-llvm", "-Xclang", "-disable-llvm-passes", "-ftime-trace",
                    "-ftime-trace-granularity=200", "-c", "-o", str(trace.with_suffix(".o"))], cwd=entry["directory"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return json.loads(trace.read_text(encoding="utf-8"))["traceEvents"], seconds


def times_of_headers(events, seconds):
    """{path: seconds without nested headers}. The clock of a loaded machine is scaled to the processor time."""
    total = max(event["dur"] for event in events if event["name"] == "Total ExecuteCompiler")
    own, open_files = collections.Counter(), []
    for event in sorted((event for event in events if event["name"] == "Source"), key=lambda event: (event["ts"], -event["dur"])):
        while open_files and open_files[-1]["ts"] + open_files[-1]["dur"] <= event["ts"]:
            open_files.pop()
        spent = event["dur"] / total * seconds
        own[event["args"]["detail"]] += spent
        if open_files:
            own[open_files[-1]["args"]["detail"]] -= spent
        open_files.append(event)
    return own


def owner(path):
    """Name of the library of a header; the path below the root for ours."""
    name = str(pathlib.Path(path).resolve())
    if name.startswith(f"{ROOT}/"):
        return f"`{name[len(str(ROOT)) + 1:]}`"
    return next((library for part, library in LIBRARIES if part in name), STANDARD)


def table(heads, rows):
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", default="build", type=pathlib.Path)
    parser.add_argument("--batches", type=int, default=8, help="rows of the first table")
    parser.add_argument("--headers", type=int, default=8, help="rows of the last table")
    parser.add_argument("--module", default="", help="only batches of this module")
    options = parser.parse_args()
    if not shutil.which("clang++"):
        parser.error("clang++ is not installed; scripts/setup --fuzz installs it")
    entries = [entry for entry in json.loads((options.build / "compile_commands.json").read_text(encoding="utf-8"))
               if re.search(rf"/src/CMakeFiles/straytrace_{options.module or '[a-z]+'}\.dir/Unity/", entry["file"])]
    if not entries:
        parser.error(f"no batches of src/ in {options.build / 'compile_commands.json'}; is the build configured?")
    batches, cost, used = [], collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as place:
        for entry in entries:
            events, seconds = trace_of(entry, pathlib.Path(place))
            spent = collections.Counter()
            for path, time in times_of_headers(events, seconds).items():
                if not path.endswith((".cpp", ".cxx")):
                    spent[owner(path)] += time
            cost.update(spent)
            used.update(spent.keys())
            ours = sum(time for name, time in spent.items() if name.startswith("`"))
            file = pathlib.Path(entry["file"])
            module = file.parents[1].name.removeprefix("straytrace_").removesuffix(".dir")
            batches.append((seconds, [f"`{module}`, batch {file.name.split('_')[1]}", str(file.read_text(encoding="utf-8").count("#include")),
                                      *(f"{time:.1f}" for time in (seconds, sum(spent.values()) - ours, ours, seconds - sum(spent.values())))]))
    total = sum(seconds for seconds, _ in batches)
    print(f"{len(batches)} batches, {total:.0f} s of processor time\n")
    print(table(["batch", "files", "front end [s]", "libraries [s]", "our headers [s]", "code [s]"],
                [row for _, row in sorted(batches, reverse=True)[:options.batches]]))
    libraries = [name for name, _ in cost.most_common() if not name.startswith("`")]
    for head, names in (("library", libraries), ("our header", [name for name, _ in cost.most_common() if name not in libraries])):
        print(table([head, "batches", "parse [s]", "share"],
                    [[name, str(used[name]), f"{cost[name]:.1f}", f"{cost[name] / total:.1%}"] for name in names[:options.headers]]))


if __name__ == "__main__":
    main()
