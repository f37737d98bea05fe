#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`straytrace paths --where` and the filter of a report choose the same rows and give the same messages.

Usage: test_filter.py PROGRAM. The script of the page runs in node on the table of the page."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[3]
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)
HARNESS = """
const {table, texts} = JSON.parse(require('fs').readFileSync(0));
const ids = table.columns.find(c => c.key === 'id').values;
console.log(JSON.stringify(texts.map(text => {
  try {
    const test = rowTest(text, table);
    return {ids: ids.filter((_, i) => test(i))};
  } catch (error) {
    if (!(error instanceof FilterProblem)) throw error;
    return {error: error.message};
  }
})));
"""
# Each of these must let some rows through and stop others.
CHOICES = (
    'via("sensor") and scatters == 3', 'via("s*r")', 'not via("sensor", "fold*")', 'h(30 Hz) > 1e-26', 'H(0.03 kHz)>1e-26/sqrt(Hz)',
    'share > 1 %', 'share > 10000 ppm', 'SHARE<1% OR rank==1', 'opl > 3.1 km', 'opl>3.1e5cm and not (opl < 20 km)', 'delay >= 10.1 us',
    'coupling > 1e-40', 'coupling > 1e-38 %', 'resolved', 'not resolved', "body('b*') and first(\"*n*\") or last('sensor')", 'sensor',
    'scatters != 3', 'bounces <= 2', 'objects == 3', 'phase_sensitivity > 2e7 rad/m', 'histories > 4000', 'largest < 0.04 %', 'without < -0.1 %',
    'route("*fold*")', 'status("unresolved*")', 'regime("linear*")', 'via("other")  or rank == 2')
BROKEN = (
    'scaters == 2', 'xyzzyx > 1', 'share > 5', 'opl > 5 kHz', 'rank < 3 m', 'scatters = 2', '2 == scatters', 'via(sensor)', 'via("a)',
    '(resolved', 'resolved and', 'h(30) > 1', 'h(30 m) > 1', 'share >', 'share and resolved', 'resolved resolved()', 'kind("µ") § 2',
    'port == "arm"', 'share > %', 'h > 3', '(' * 100 + 'resolved', 'colour() > 1', 'not', '"', 'ETM and ITM', 'opl > 5 %', '! resolved')


def check(true, what):
    if not true:
        sys.exit(f"test_filter: {what}")


def straytrace(*words, folder, code=0):
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=folder, capture_output=True, text=True)
    check(done.returncode == code, f"{' '.join(map(str, words))}: {done.returncode}, {done.stderr}")
    return done.stdout if code == 0 else done.stderr


def page_answers(table, texts):
    script = (SOURCE / "data/page/filter.js").read_text() + HARNESS
    done = subprocess.run(["node", "-e", script], input=json.dumps({"table": table, "texts": texts}), capture_output=True, text=True)
    check(done.returncode == 0, f"node: {done.stderr}")
    return json.loads(done.stdout)


def program_answer(folder, text):
    return [r["id"] for r in json.loads(straytrace("paths", "out/run.h5", "--where", text, "--format", "json", folder=folder))["routes"]]


def first_problem(folder, text):
    """The message of the page: place, error, remedy."""
    said = straytrace("paths", "out/run.h5", "--where", text, folder=folder, code=2).splitlines()
    place = re.match(r"error: --where, (column \d+: .*)", said[0])
    check(place is not None, f"{text}: {said}")
    caret = re.match(r" *\^+ (.*)", said[2])
    return f"{place[1]}: {caret[1]}"


def check_without(folder):
    """The rest are routes that pass no sensor; the page's rule of sums, root of the sum of squares, agrees."""
    answer = json.loads(straytrace("paths", "out/run.h5", "--without", "sensor", "--format", "json", folder=folder))
    left = set(r["id"] for r in answer["routes"])
    check(left == set(program_answer(folder, 'not via("sensor")')), "--without leaves out other routes than via() has")
    for k, s in enumerate(answer["without"]["strain"]):
        if s["after"] is None:
            continue
        rows = [r["strain"][k]["value"] for r in answer["routes"] if r["resolved"]]
        check(abs(sum(h * h for h in rows)**0.5 / s["after"]["value"] - 1) < 5e-3, f"sum without a sensor at {s['frequency_Hz']} Hz")
        check(s["after"]["value"] < s["before"]["value"] and s["factor"]["sigma"] > 0, "leaving routes out adds noise")
    said = straytrace("paths", "out/run.h5", "--without", "sensr", "--where", "scaters > 1", "--sort", "shar", folder=folder, code=2)
    for words in ("did you mean 'sensor'?", "did you mean 'scatters'?", "did you mean 'share'?"):
        check(words in said, f"one error hides another: {said}")
    csv = straytrace("paths", "out/run.h5", "--where", "rank <= 3", "--sort", "opl", "--csv", folder=folder)
    check(len([line for line in csv.splitlines() if not line.startswith("#")]) == 4, "the CSV has other rows")
    for words in (("--where", "resolved", "--census"), ("--sort", "opl", "--by", "receiver")):
        straytrace("paths", "out/run.h5", *words, folder=folder, code=2)


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        straytrace("run", SOURCE / "examples/end_bench.yaml", "-o", "out", "--histories", 2**18, "--quiet", folder=folder)
        straytrace("report", "out/run.h5", "-o", "page.html", folder=folder)
        table = json.loads(DATA.search((folder / "page.html").read_text()).group(1))["table"]
        said = page_answers(table, CHOICES + BROKEN)
        for text, answer in zip(CHOICES, said):
            wanted = program_answer(folder, text)
            check("ids" in answer, f"{text}: the page says {answer}")
            check(answer["ids"] == wanted, f"{text}: the page chooses {len(answer['ids'])} rows, the program {len(wanted)}")
            check(0 < len(wanted) < table["rows"], f"{text} chooses {len(wanted)} of {table['rows']}: it proves nothing")
        for text, answer in zip(BROKEN, said[len(CHOICES):]):
            check(answer.get("error") == first_problem(folder, text), f"{text}: page {answer}, program {first_problem(folder, text)}")
        control = page_answers(table, ("scatters >= 3",))[0]["ids"]                     # negative control: the comparison can fail
        check(control != program_answer(folder, "scatters > 3"), "two conditions choose the same rows")
        check_without(folder)
    print("test_filter: ok")


if __name__ == "__main__":
    main()
