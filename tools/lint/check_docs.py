#!/usr/bin/env python3
"""Fail for a dead link in the documents; a missing file or test that documents, messages or tests/long.txt name; a shape, BSDF model or
interface without its page; a missing page or equation that code cites; a test that skips and is not documented; a picture of a tree
with uncommitted changes. Usage: check_docs.py [ROOT]"""
import pathlib
import re
import struct
import sys

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)
KEY = re.compile(r'static constexpr char const\* key = "([a-z_-]+)";')
NAMED_FILE = re.compile(r"`((?:\.ci|docs|examples|python|schema|scripts|src|tests|tools)/[\w./-]+)`")
WITH_TESTS = ("docs/develop/conventions.md", "docs/theory/validation.md")   # pages that name tests, as `Suite.name`
LONG_TESTS = "tests/long.txt"                            # one name a line, of a test or a suite.*
NAMED_TEST = re.compile(r"`([A-Za-z_]\w*\.[A-Za-z]\w+)`")
TEST = re.compile(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+),\s*(\w+)\)", re.MULTILINE)
PAGES = {"geometry": ("shapes",), "optics": ("scatter", "interfaces")}  # room of src/: folders of docs/reference/
CITED = re.compile(r"\beqs?\. \(?(\d+\.\d+|C\.\d+)")
TAG = re.compile(r"\\tag\{([^}]*)\}")                   # "5.4", "5.5, 5.6" or "5.1–5.3"
# Names of files in what a program prints, and in pages outside of links.
STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
TOLD_FILE = re.compile(r"(?<![\w./<-])((?:(?:docs|examples|library|scripts|tests|tools)/[\w./-]*\w)|[\w/-]+\.md)\b")
PAGE = re.compile(r"(?<![\w./\"-])[\w./-]*\w\.md\b")    # a page that code cites
ON_PAGE = re.compile(r"(docs/theory/\w+\.md),?\s(?:// |# )?\s*eqs?\. (\d+\.\d+)")
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


SKIPS = re.compile(r"GTEST_SKIP\(|skipTest\(|unittest\.skip|echo 'skipped|SKIP_RETURN_CODE")
TESTING = "docs/develop/testing.md"
CODE_FILES = {".cpp", ".hpp", ".h", ".cu", ".py", ".sh", ".js", ""}
MADE_UP = {"tests/tools/tree/test_checks.py"}           # names pages that do not exist


def text_of(page):
    return CODE.sub("", page.read_text(encoding="utf-8"))


def anchors(page):
    """Anchors as GitHub makes them: lower case, punctuation dropped, spaces to hyphens."""
    return {re.sub(r"[^\w\- ]", "", h.strip().lower()).replace(" ", "-") for h in HEADING.findall(text_of(page))}


def dead_links(root, pages):
    for page in pages:
        for target in LINK.findall(text_of(page)):
            if re.match(r"[a-z]+:", target):
                continue                                # another site
            file, _, anchor = target.partition("#")
            place = (page.parent / file).resolve() if file else page
            folder = place.is_dir() and page.is_relative_to(root / "docs")    # Sphinx has no page for it
            if folder or not place.exists():
                yield f"{page.relative_to(root)}: no such file: {target}"
            elif anchor and place.suffix == ".md" and anchor not in anchors(place):
                yield f"{page.relative_to(root)}: no such heading: {target}"


def missing_files(root, pages):
    for page in pages:
        for name in NAMED_FILE.findall(text_of(page)):
            if "NAME" not in name and not (root / name).exists():
                yield f"{page.relative_to(root)}: there is no {name}"


def told_files(root, pages):
    """Files that messages, pages of reports and documents name and that a reader would not find. Names of pages may leave
    out their folders."""
    code = [file for room, ends in (("src", "[ch]pp"), ("step", "[ch]pp"), ("data/page", "js"), ("python", "py"))
            for file in (root / room).rglob(f"*.{ends}")]
    known = {page.name for page in pages}
    for file in sorted(code):
        for text in STRING.findall(re.sub(r"^\s*(//|#).*$", "", file.read_text(encoding="utf-8"), flags=re.MULTILINE)):
            for name in TOLD_FILE.findall(text):
                if not (root / name).exists():
                    yield f"{file.relative_to(root)}: names {name}, which does not exist"
    for page in pages:
        for name in TOLD_FILE.findall(LINK.sub("", text_of(page))):
            if name.endswith(".md") and "NAME" not in name and name not in known and not (root / name).exists() and not (page.parent / name).exists():
                yield f"{page.relative_to(root)}: there is no {name}"


def tests_of(root):
    for source in (root / "tests").rglob("*.cpp"):
        yield from (f"{suite}.{name}" for suite, name in TEST.findall(source.read_text(encoding="utf-8")))
    for listing in (root / "tests").glob("CMakeLists.txt"):
        yield from re.findall(r"NAME ([a-z]+\.[a-z_]+)", listing.read_text(encoding="utf-8"))


def missing_tests(root):
    known = set(tests_of(root))
    for page in WITH_TESTS:
        named = NAMED_TEST.findall(text_of(root / page)) if (root / page).exists() else []
        for name in named:
            if name not in known:
                yield f"{page}: there is no test {name}"
        if not named:
            yield f"{page}: no tests named; is the path right?"
    listed = root / LONG_TESTS
    for name in listed.read_text(encoding="utf-8").split("\n") if listed.exists() else ():
        suite = name.endswith(".*") and any(test.startswith(name[:-1]) for test in known)
        if re.fullmatch(r"[A-Za-z_]\w*\.(\w+|\*)", name) and not name.startswith("fuzz.") and name not in known and not suite:
            yield f"{LONG_TESTS}: there is no test {name}"


def missing_pages(root):
    for room, folders in PAGES.items():
        keys = [k for header in sorted((root / "src" / room).rglob("*.hpp")) for k in KEY.findall(header.read_text())]
        if not keys:
            yield f"src/{room}: no keys found; is the path right?"
        for key in keys:
            if not any((root / "docs" / "reference" / folder / f"{key}.md").exists() for folder in folders):
                yield f"docs/reference/{' or '.join(folders)}/{key}.md is missing: the page of '{key}'"


def equations_of(page):
    """Numbers of the equations that a page sets."""
    found = set()
    for tag in TAG.findall(page.read_text(encoding="utf-8")):
        ends = re.findall(r"(\w+)\.(\d+)", tag)
        for (chapter, first), (_, last) in zip(ends, ends[1:] if "–" in tag else ends):
            found |= {f"{chapter}.{number}" for number in range(int(first), int(last) + 1)}
    return found


def repeated_equations(root):
    """Numbers that two equations of a page bear; other pages may show an equation again."""
    for page in sorted((root / "docs" / "theory").glob("*.md")):
        first = {}
        for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
            for tag in (t for found in TAG.findall(line) for t in found.split(", ")):
                where = f"{page.relative_to(root)}:{number}"
                if tag in first:
                    yield f"{where}: equation {tag} is that of {first[tag]}; give it a number of its own"
                first.setdefault(tag, where)


def code_files(root):
    for folder in ("src", "step", "tests", "fuzz", "bench", "python", "tools", "scripts", "data/page"):
        for file in sorted((root / folder).rglob("*")):
            if file.is_file() and file.suffix in CODE_FILES and "corpus" not in file.parts and str(file.relative_to(root)) not in MADE_UP:
                yield file


def wrong_citations(root):
    """Pages and equations that code cites and a reader of the repository would not find."""
    pages = {str(page.relative_to(root)): equations_of(page) for page in sorted((root / "docs" / "theory").glob("*.md"))}
    known = set().union(*pages.values())
    for file in code_files(root):
        text = file.read_text(encoding="utf-8")
        for name in sorted(set(PAGE.findall(LINK.sub("", text)))):
            if not (root / name).is_file() and "NAME" not in name:
                yield f"{file.relative_to(root)}: cites {name}, which is not in the repository; cite docs/theory/NAME.md, eq. N"
        for name, equation in sorted(set(ON_PAGE.findall(text))):
            if equation in known and equation not in pages.get(name, ()):
                yield f"{file.relative_to(root)}: {name} does not set equation {equation}"
        if file.suffix in (".cpp", ".hpp"):
            for equation in sorted(set(CITED.findall(text)) - known):
                yield f"{file.relative_to(root)}: no page of docs/theory sets equation {equation}"


def silent_skips(root):
    page = root / TESTING
    told = page.read_text(encoding="utf-8") if page.exists() else ""
    for file in sorted((root / "tests").rglob("*")):
        if file.suffix in (".cpp", ".py", ".sh", ".txt") and SKIPS.search(file.read_text(encoding="utf-8")) \
                and f"`{file.relative_to(root)}`" not in told:
            yield f"{file.relative_to(root)}: skips, and {TESTING} does not say when"


def words_in_png(file):
    """All text chunks of a PNG file."""
    data, at, words = file.read_bytes(), 8, b""
    while at + 8 <= len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        words += data[at + 8:at + 8 + size] + b"\n" if kind in (b"tEXt", b"iTXt") else b""
        at += size + 12
    return words.decode("latin-1")


def dirty_pictures(root):
    for file in sorted((root / "docs").rglob("*.png")):
        if "-dirty" in words_in_png(file):
            yield f"{file.relative_to(root)}: drawn by a program with uncommitted changes; commit, build, scripts/pictures"


def main(root):
    pages = sorted(root.glob("*.md")) + sorted((root / "docs").rglob("*.md"))
    if not pages:
        print(f"{root}: no pages found; is the path right?")
        return 1
    found = [*dead_links(root, pages), *missing_files(root, pages), *told_files(root, pages), *missing_tests(root),
             *missing_pages(root), *wrong_citations(root), *repeated_equations(root), *silent_skips(root), *dirty_pictures(root)]
    print("\n".join(found) or f"{len(pages)} pages are in order")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()))
