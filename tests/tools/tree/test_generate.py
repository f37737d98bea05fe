#!/usr/bin/env python3
"""scripts/generate --check: the generated files of this tree are up to date, and in a copy of the tree all files that were
changed by hand are found and written anew. Usage: test_generate.py PROGRAM"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).parents[3]
# A generated line of each file, and what a hand would make of it.
CHANGES = (("schema/straytrace-1.schema.json", '"$schema"', '"$Schema"'),
           ("docs/reference/keys.md", "\n| ", "\n|  "),
           ("docs/reference/commands.md", "\n| `--quiet` |", "\n| `--silence` |"),
           ("docs/reference/library.md", "| material | value", "| material |  value"),
           ("docs/reference/python.md", "\n## Models", "\n## The models"))


def generate(tree, build, *options):
    """The exit code of scripts/generate in a tree, and what it printed."""
    done = subprocess.run([tree / "scripts/generate", *options], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env=os.environ | {"STRAYTRACE_BUILD": str(build)})
    return done.returncode, done.stdout


def main(program):
    build = pathlib.Path(program).resolve().parent
    code, printed = generate(ROOT, build, "--check")
    assert code == 0, printed
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder) / "tree"
        for name in ("bench", "data", "docs", "examples", "library", "python", "schema", "scripts", "src", "tools"):
            shutil.copytree(ROOT / name, tree / name, ignore=shutil.ignore_patterns("__pycache__"))
        right = {}
        for name, old, new in CHANGES:
            right[name] = (tree / name).read_text(encoding="utf-8")
            assert old in right[name], f"{name}: no '{old}' in it; is the test out of date?"
            (tree / name).write_text(right[name].replace(old, new, 1), encoding="utf-8")
        code, printed = generate(tree, build, "--check")
        assert code != 0, "files were changed by hand, and --check accepts them"
        missed = [name for name in right if pathlib.Path(name).name not in printed]
        assert not missed, f"--check says nothing of {missed}: {printed}"
        code, printed = generate(tree, build)
        assert code == 0, printed
        for name, text in right.items():
            assert (tree / name).read_text(encoding="utf-8") == text, f"{name} is not written as it was"


if __name__ == "__main__":
    main(sys.argv[1])
