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
CASES = json.loads((SOURCE / "tests/support/filter_cases.json").read_text(encoding="utf-8"))


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


def check_cases():
    """The same table and cases as those of the program (tests/unit/results/filter.cpp)."""
    table, chooses, rejects = CASES["table"], CASES["chooses"], CASES["rejects"]
    ids = next(column["values"] for column in table["columns"] if column["key"] == "id")
    said = page_answers(table, [case["filter"] for case in chooses + rejects])
    for case, answer in zip(chooses, said):
        check(answer.get("ids") == [ids[rank - 1] for rank in case["rows"]], f"{case}: the page says {answer}")
    for case, answer in zip(rejects, said[len(chooses):]):
        check(answer.get("error") == case["error"], f"{case}: the page says {answer}")


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
    check_cases()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        straytrace("run", SOURCE / "examples/end_bench.yaml", "-o", "out", "--histories", 2**18, "--quiet", folder=folder)
        straytrace("report", "out/run.h5", "-o", "page.html", folder=folder)
        table = json.loads(DATA.search((folder / "page.html").read_text()).group(1))["table"]
        rejected = [case["filter"] for case in CASES["rejects"]]
        said = page_answers(table, CASES["end_bench"] + rejected)
        for text, answer in zip(CASES["end_bench"], said):
            wanted = program_answer(folder, text)
            check("ids" in answer, f"{text}: the page says {answer}")
            check(answer["ids"] == wanted, f"{text}: the page chooses {len(answer['ids'])} rows, the program {len(wanted)}")
            check(0 < len(wanted) < table["rows"], f"{text} chooses {len(wanted)} of {table['rows']}: it proves nothing")
        for text, answer in zip(rejected, said[len(CASES["end_bench"]):]):
            program = first_problem(folder, text)
            check(answer.get("error") == program or "known from" in program, f"{text}: page {answer}, program {program}")
        control = page_answers(table, ("scatters >= 3",))[0]["ids"]                     # negative control: the comparison can fail
        check(control != program_answer(folder, "scatters > 3"), "two conditions choose the same rows")
        check_without(folder)
    print("test_filter: ok")


if __name__ == "__main__":
    main()
