# SPDX-License-Identifier: BSD-3-Clause
"""Records of benchmarks: one JSON line per comparison, with commit, compiler, machine and load; children with their time and memory.

A line holds, where they apply: bench, case, ours, theirs (medians over the repeats), ratio (of turns, above 1: ours is better),
spread ((largest - least) / median of the ratios; without theirs, of ours), unit (of ours and theirs), peak_memory and
theirs_peak_memory (bytes), error. A goal is {"of": field, "at_least" or "at_most": value, "name": where it is not the case}; met
says whether. What was not done says `skipped` and why.
"""
import argparse
import dataclasses
import datetime
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[1]
BUILD = SOURCE / "build-bench"
KEPT = SOURCE / "bench" / "results"                      # versioned: what the page shows
QUIET = dict(os.environ, STRAYTRACE_PYTHON="/bin/false")           # no pictures


def arguments(doc, **defaults):
    """The parser that all drivers share; doc is the help text."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=BUILD / "straytrace", help="straytrace (build-bench/straytrace)")
    parser.add_argument("--keep", action="store_true", help="replace the lines of this bench on this processor in bench/results, for the page")
    parser.add_argument("--quick", action="store_true", help="everything once and tiny: does it run? No numbers to keep")
    parser.add_argument("--repeats", type=int, default=defaults.get("repeats", 5), help="turns of each comparison (%(default)s)")
    parser.add_argument("--results", type=pathlib.Path, default=BUILD / "results.jsonl", help="where lines are appended")
    return parser


def said_by(*words):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, cwd=SOURCE)
    return done.stdout.strip() if done.returncode == 0 else ""


def cached(name, folder=BUILD):
    """A setting of the build in `folder`, "" if there is none."""
    file = folder / "CMakeCache.txt"
    found = re.search(rf"^{name}:\w+=(.*)$", file.read_text(), re.MULTILINE) if file.exists() else None
    return found.group(1) if found else ""


def machine(folder=BUILD):
    """Commit ("+" behind it: the tree had changes), compiler, flags, processor, cores."""
    changed = said_by("git", "status", "--porcelain", "--untracked-files=no", "--", ".", ":!bench/results", ":!docs")
    model = re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    return {"commit": said_by("git", "rev-parse", "--short=10", "HEAD") + ("+" if changed else ""),
            "compiler": said_by(cached("CMAKE_CXX_COMPILER", folder) or "c++", "--version").split("\n")[0],
            "flags": " ".join(f"{cached('CMAKE_CXX_FLAGS_RELEASE', folder)} {cached('CMAKE_CXX_FLAGS', folder)}".split()),
            "processor": model.group(1) if model else "unknown", "cores": os.cpu_count()}


class Results:
    """Lines of one bench: `with Results("noise", words) as results: results.add("case", ours=...)`. Appended as they come; with
    --keep the kept lines of the bench on this processor are replaced at the end, if all went well. `part`: the option, and field of the
    lines, by which some of the bench can be run alone; then lines of other parts stay. `on_any`: the processor does not matter."""

    def __init__(self, bench, words, part=None, on_any=False):
        if words.quick and words.keep:
            sys.exit("--keep: the numbers of --quick say nothing; leave one of the two out")
        self.bench, self.words, self.lines, self.on_any = bench, words, [], on_any
        self.part = part if part and getattr(words, part) else None
        self.about = machine(words.program.resolve().parent)

    def __enter__(self):
        self.words.results.parent.mkdir(parents=True, exist_ok=True)
        return self

    def add(self, case, **fields):
        if goal := fields.get("goal"):
            measured = fields[goal["of"]]
            fields["met"] = measured >= goal["at_least"] if "at_least" in goal else measured <= goal["at_most"]
        line = {"bench": self.bench, "case": case, "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
                **self.about, "load": round(os.getloadavg()[0], 2), **fields}
        self.lines.append(line)
        with open(self.words.results, "a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        print(json.dumps({key: value for key, value in line.items() if key not in self.about}), flush=True)

    def __exit__(self, failure, *_):
        if failure is None and self.words.keep:
            KEPT.mkdir(exist_ok=True)
            file = KEPT / f"{self.bench}.jsonl"
            new = file.with_suffix(".new")
            new.write_text("".join(json.dumps(line) + "\n" for line in [*self.kept_of(file), *self.lines]), encoding="utf-8")
            new.replace(file)

    def kept_of(self, file):
        """Lines that stay: of other processors, and of other parts, where a part was run alone."""
        lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()] if file.exists() else []
        return [line for line in lines if not self.on_any and line["processor"] != self.about["processor"]
                or self.part and line[self.part] not in {new[self.part] for new in self.lines}]


def newest(lines):
    """Of each group or scene that can be measured alone, those of the processor that was measured last."""
    last = {}
    for line in sorted(lines, key=lambda line: line["date"]):
        last[part_of(line)] = line["processor"]
    return [line for line in lines if line["processor"] == last[part_of(line)]]


def part_of(line):
    return line.get({"engine": "scene", "growth": "group"}.get(line["bench"]))


@dataclasses.dataclass
class Child:
    """Resources of a child: wall-clock seconds, processor seconds of it and its children, bytes of the largest of them."""
    seconds: float
    cpu: float
    peak_memory: int
    output: str


def child(command, core=None, env=None, code=0, cwd=None):
    """Run a command, on one core if a core is named; exits with its message if it does not end with `code`.

    Memory is what GNU time reports: a child of Python itself would start with the peak of Python's memory.
    """
    pinned = ["taskset", "-c", str(core)] if core is not None else []
    with tempfile.NamedTemporaryFile("r") as memory, tempfile.TemporaryFile("w+") as said:
        start = time.monotonic()
        process = subprocess.Popen([*pinned, "time", "-q", "-f", "%M", "-o", memory.name, *map(str, command)], stdout=said,
                                   stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, env=env or QUIET, cwd=cwd)
        _, status, used = os.wait4(process.pid, 0)
        seconds = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        output = said.read()
        if process.returncode != code:
            sys.exit(f"{' '.join(map(str, command))}: ends with {process.returncode}\n{output}")
        return Child(seconds, used.ru_utime + used.ru_stime, 1024 * int(memory.read()), output)


def in_turns(ways, repeats):
    """{name: [result of each turn]} of {name: function}: one after the other, so that a change of load meets all of them."""
    taken = {name: [] for name in ways}
    for _ in range(repeats):
        for name, way in ways.items():
            taken[name].append(way())
    return taken


def spread(values):
    return (max(values) - min(values)) / statistics.median(values)


def compared(ours, theirs=None, less_is_better=True):
    """ours, theirs, ratio, spread and repeats of a line, from one number per turn."""
    if theirs is None:
        return {"ours": statistics.median(ours), "spread": spread(ours), "repeats": len(ours)}
    ratios = [b / a if less_is_better else a / b for a, b in zip(ours, theirs)]
    return {"ours": statistics.median(ours), "theirs": statistics.median(theirs), "ratio": statistics.median(ratios),
            "spread": spread(ratios), "repeats": len(ours)}


def lines_of(program, *words):
    """(line, peak memory of the program) of each JSON line that a program of build-bench prints, on the last core."""
    done = child([BUILD / program, *words], core=max(os.sched_getaffinity(0)))
    for line in done.output.splitlines():
        if line.startswith("{"):
            yield json.loads(line), done.peak_memory
