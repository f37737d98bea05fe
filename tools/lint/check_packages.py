#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fail for a file of /usr that build, tests or scripts use and that no package listed by scripts/setup brings, so that a
package installed by hand on one machine hides nothing. Usage: check_packages.py BUILD_DIR [--without PACKAGE]...

Three lists are checked: what compiles and links straytrace and straytrace-step against `scripts/setup --list`, everything
against `scripts/setup --test --list`, and what runs other programs in bench/peers against that with --peers; each with what apt installs along with it, without recommended packages, on top of
a minimal Debian. --without leaves packages out of all lists.
"""
import argparse
import ast
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DPKG = pathlib.Path("/var/lib/dpkg")
FOLDERS = ("scripts", "tools", "tests", "python", "bench", "fuzz", "mpi", "step", "src", ".ci")
PEERS = ROOT / "bench/peers"
SUFFIXES = {"", ".sh", ".py", ".js", ".bash", ".cpp", ".hpp", ".txt", ".cmake"}
SYSTEM_PYTHON = pathlib.Path("/usr/lib/python3/dist-packages")
# These name packages and files without using them.
LISTS = (ROOT / "scripts/setup", ROOT / "tools/lint/check_packages.py", ROOT / "tests/tools/tree/test_packages.py")
STARTERS = {"", ".sh", ".bash", ".py", ".cpp", ".hpp"}  # sources that start programs
OPTIONAL = {"/usr/bin/ccache"}  # used where it is found
PATH = re.compile(r"""(?<![\w.$}/-])/usr/(?!local/)[^\s"'`:;,|)(\\$<>*?{}\[\]]+""")
# Command position of a shell script: after a separator, or after a word that takes a command, and after assignments.
BEFORE = r"(?:\b(?:if|then|else|do|while|until|exec|time|sudo|as_root|xargs|env)(?= )|^|[|;&`]|[$<>]\()"
IN_SHELL = BEFORE + r" *(?:\w+=(?:[^(\s$]\S*|\$\w+)? +)*{}(?=[ ;)|&]|$)"
IN_PYTHON = r"(?:\b(?:run|Popen|check_output|check_call|call|which)\(\s*[\[(]?|(?<![\w\])])\[)\s*f?[\"']{}[\"' ]"
IN_CPP = r"\b(?:system|popen|run_child)\(.*\"{} "


class Packages:
    """Packages installed on this machine: which package owns a file, which packages a list brings."""

    def __init__(self):
        self.fields, self.providers, self.owners = {}, {}, {}
        for block in (DPKG / "status").read_text(errors="replace").split("\n\n"):
            fields = dict(re.findall(r"^([A-Z][\w-]*): (.*)$", block, re.MULTILINE))
            if fields.get("Status", "").endswith(" installed"):
                self.fields[fields["Package"]] = fields
                for name in self.names(fields.get("Provides", "")):
                    self.providers.setdefault(name[0], []).append(fields["Package"])
        for listing in (DPKG / "info").glob("*.list"):
            package = listing.stem.split(":")[0]
            for path in listing.read_text(errors="replace").split("\n"):
                self.owners.setdefault(path if path.startswith("/usr/") else "/usr" + path, set()).add(package)

    @staticmethod
    def names(relation):
        """[[a, b], [c]] of 'a (>= 1) | b, c:any'."""
        return [[re.split(r"[ (:\[]", one.strip())[0] for one in group.split("|")] for group in relation.split(",") if group]

    def chosen(self, alternatives, have):
        for name in alternatives:
            if name in self.fields:
                return name
            if providers := self.providers.get(name):
                return next((p for p in providers if p in have), providers[0])
        return None

    def closure(self, listed):
        """All packages that apt installs for `listed`, without recommended ones, and those of a minimal Debian."""
        minimal = [n for n, f in self.fields.items() if f.get("Essential") == "yes" or f.get("Priority") == "required"]
        have, waiting = set(), [*minimal, "apt", *listed]
        while waiting:
            name = waiting.pop()
            if name in have or name not in self.fields:
                continue
            have.add(name)
            for key in ("Depends", "Pre-Depends"):
                groups = self.names(self.fields[name].get(key, ""))
                waiting += [found for group in groups if (found := self.chosen(group, have))]
        return have

    def owners_of(self, path):
        """Packages that hold the file or, where none does, what it links to; none for files without a package."""
        if path in self.owners:
            return self.owners[path]
        return self.owners.get(str(pathlib.Path(path).resolve()), set())


def output_of(*words):
    return subprocess.run([*map(str, words)], capture_output=True, text=True, check=True).stdout


def built_with(build, *targets):
    """{path: where it is named} of commands, headers and libraries of the targets; all of them without one."""
    named = {}
    for path in PATH.findall(output_of("ninja", "-C", build, "-t", "commands", *(targets or ["all"]))):
        named.setdefault(path, "commands of the build")
    rooms = ("src/", "step/CMakeFiles/straytrace_step.dir", "step/CMakeFiles/straytrace-step.dir") if targets else ("",)
    wanted = False
    for line in output_of("ninja", "-C", build, "-t", "deps").split("\n"):
        if not line.startswith(" "):
            wanted = line.startswith(rooms)
        elif wanted and PATH.fullmatch(path := line.strip()):
            named.setdefault(path, "headers of the build")
    cache = (build / "CMakeCache.txt").read_text()
    if not targets:
        for path in re.findall(r"^(?:CMAKE_MAKE_PROGRAM|\w+_DIR):\w+=(/usr/(?!local/)\S+)", cache, re.MULTILINE):
            named.setdefault(path, "CMakeCache.txt")
    programs = targets or ("straytrace", "straytrace-step", "straytrace-step-sample", "straytrace-mpi.so", "unit_base")
    for program in programs:
        if (build / program).exists():
            for path in re.findall(r"=> (/\S+)", output_of("ldd", build / program)):
                named.setdefault(path if path.startswith("/usr/") else "/usr" + path, f"libraries of {program}")
    return named


def sources():
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            skipped = path in LISTS or {"corpus", "__pycache__"} & set(path.parts)
            if path.is_file() and path.suffix in SUFFIXES and not skipped:
                yield path


def modules_of(text):
    """Top-level names that a Python source imports."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.split(".")[0]


def started_programs(text, suffix, programs):
    """Those of `programs` (names) that a source starts, but for ones it asks for before."""
    pattern = {".py": IN_PYTHON, ".cpp": IN_CPP, ".hpp": IN_CPP}.get(suffix, IN_SHELL)
    code = re.sub(r"(?m)^\s*(?:#|//).*|\s#\s.*$", "", text)
    if pattern is IN_SHELL:
        code = re.sub(r"<<-?'?(\w+)'?.*?\n(.*?\n)\1\n", "\n", code, flags=re.DOTALL)  # texts
        code = re.sub(r"(?m)^ *[\w| -]+\) ?", "", code)  # labels of a case
    calls = "(?=" + pattern.format(r"(?:/usr/s?bin/)?([\w.+-]+)") + ")"  # looked ahead: `if` may be followed by `time`
    for name in re.findall(calls, code, re.MULTILINE):
        asked_for = rf"command -v {re.escape(name)}\b|which\(\"{re.escape(name)}\"\)"
        if name in programs and not re.search(asked_for, text):
            yield programs[name]


def imported_files(text):
    """Where Debian keeps the modules that a Python source imports."""
    for module in modules_of(text):
        yield from (str(path) for path in (SYSTEM_PYTHON / module, SYSTEM_PYTHON / f"{module}.py") if path.exists())


def used_by_program():
    """{path: file that uses it} of the scripts that draw the pictures of the program with Debian's Python."""
    scripts = sorted((ROOT / "python/straytrace/plots").glob("*.py"))
    return {path: str(script.relative_to(ROOT)) for script in scripts for path in imported_files(script.read_text())}


def used_by_sources(build, peers):
    """{path: file that uses it} of files that tests, tools and scripts name, start and import outside build/compare; `peers`: those that run
    other programs."""
    named = {}
    programs = {p.name: str(p) for folder in ("/usr/sbin", "/usr/bin") for p in pathlib.Path(folder).iterdir()}
    shipped = {p.stem for p in (build / "compare/lib").glob("python*/site-packages/*")}
    for source in sources():
        if (PEERS in source.parents) != peers:
            continue
        try:
            text = source.read_text()
        except UnicodeDecodeError:
            continue
        if not source.suffix and not text.startswith("#!"):
            continue
        found = PATH.findall(text)
        if source.suffix in STARTERS:
            found += started_programs(text, source.suffix, programs)
        if source.suffix == ".py":
            found += [path for path in imported_files(text) if pathlib.Path(path).stem not in shipped]
        for path in found:
            named.setdefault(path, str(source.relative_to(ROOT)))
    return named


def problems(packages, listed, named, how):
    have = packages.closure(listed)
    for path, where in sorted(named.items()):
        owners = packages.owners_of(path)
        if owners and not owners & have and path not in OPTIONAL:
            owner = " or ".join(sorted(owners))
            yield f"{path} ({where}) belongs to {owner}, which {how} does not install: list it in scripts/setup"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--without", action="append", default=[], metavar="PACKAGE")
    arguments = parser.parse_args()
    packages, setup = Packages(), ROOT / "scripts/setup"
    found, count = [], 0
    for words, named in (((), built_with(arguments.build, "straytrace", "straytrace-step") | used_by_program()),
                         (("--test",), built_with(arguments.build) | used_by_sources(arguments.build, False)),
                         (("--test", "--peers"), used_by_sources(arguments.build, True))):
        listed = [p for p in output_of(setup, *words, "--list").split() if p not in arguments.without]
        found += problems(packages, listed, named, " ".join(["scripts/setup", *words]))
        count += len(named)
    if count < 1000:
        found.append(f"only {count} files found; is {arguments.build} a finished build with Ninja?")
    print("\n".join(found) or f"{count} files of /usr belong to packages that scripts/setup installs")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
