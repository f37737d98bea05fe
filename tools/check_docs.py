#!/usr/bin/env python3
"""Fail for a dead link in the documentation, or a shape or scatter law without its page. Usage: check_docs.py [ROOT]"""
import pathlib
import re
import sys

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)
KEY = re.compile(r'static constexpr char const\* key = "([a-z-]+)";')
PAGES = {"geometry": "shapes", "optics": "scatter"}     # room of src/ : folder of docs/reference/
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


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
            if not place.exists():
                yield f"{page.relative_to(root)}: no such file: {target}"
            elif anchor and place.suffix == ".md" and anchor not in anchors(place):
                yield f"{page.relative_to(root)}: no such heading: {target}"


def missing_pages(root):
    for room, folder in PAGES.items():
        keys = [k for header in sorted((root / "src" / room).glob("*.hpp")) for k in KEY.findall(header.read_text())]
        if not keys:
            yield f"src/{room}: no keys found; is the path right?"
        for key in keys:
            if not (root / "docs" / "reference" / folder / f"{key}.md").exists():
                yield f"docs/reference/{folder}/{key}.md is missing: the page of '{key}'"


def main(root):
    pages = sorted(root.glob("*.md")) + sorted((root / "docs").rglob("*.md"))
    if not pages:
        print(f"{root}: no pages found; is the path right?")
        return 1
    found = list(dead_links(root, pages)) + list(missing_pages(root))
    print("\n".join(found) or f"{len(pages)} pages are in order")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1]).resolve()))
