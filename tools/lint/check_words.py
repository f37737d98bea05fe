#!/usr/bin/env python3
"""Fail for a private word where the field has a standard one, in pages, comments, messages and descriptions of keys.
Usage: check_words.py [ROOT]"""
import pathlib
import re
import sys

# Words with no other use in this repository, and what to write instead.
WORDS = {
    r"twins?": "negative control",
    r"(?:in the|the) books|books (?:of|close)": "energy balance",
    r"fates?": "term of the energy balance",
    r"equal scores": "effective sample size",
    r"the verdicts?": "convergence status, outcome",
    r"knock(?:s|ed|ing)?": "impulse",
    r"stands? beside": "is listed with, is off the axis",
    r"rims? of (?:a |the )?baffles?|baffle(?:'s)? rims?": "inner edge, clear aperture",
    r"(?:goes|going|gone|went) on|go on with": "resume, continue",
    r"hand-over": "minimum scatter angle",
    r"dump me first": "mitigation ranking",
    r"lights? nothing": "illuminates no surface",
    r"comes? by(?! way)": "arrives",
    r"mend(?:s|ed|ing)?": "fix",
    r"traced by (?:itself|themselves)": "traced separately",
    r"mesh doctor": "mesh checks",
    r"wager(?:s|ed)?": "roulette",
    r"phase levers?|levers? of (?:a|the) (?:route|path|body)": "phase sensitivity",
    r"told apart": "distinguished",
    r"held against": "compared with",
    r"knows? nothing of|do(?:es)? not know of": "ignores, is independent of",
    r"as it stands": "unchanged",
    r"for ever": "without end",
    r"hand(?:s|ed)? over": "passes on",
    r"at hand": "available",
    r"asks? nothing of": "does not need",
    r"is worth only": "has an effective sample size of",
    r"asked for": "requested",
    r"scatter laws?": "BSDF model, BSDF",
    r"(?:is|are|was|were) (?:refused|told|said)": "is rejected, is reported; name who does it",
    r"taken off": "subtracted, removed",
    r"(?<!there\s)(?-i:is none)": "is not one of, does not exist",    # case: Python's 'is None'
    r"by (?:itself|themselves)": "automatically, alone, separately",
}
SELF = ("tools/lint/check_words.py", "tests/tools/tree/test_checks.py")      # they name the words
PAGES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs")
CODE = ("src", "step", "mpi", "fuzz", "tests", "python", "tools", "bench", "scripts", "schema", "data/page", "examples", "library")
TEXTS = {".md", ".cpp", ".hpp", ".h", ".cu", ".py", ".sh", ".js", ".txt", ".yaml", ".json", ""}
GAP = r"(?:\s+(?:(?://|#|\*)\s*)?)"                      # a phrase may continue on the next line of a comment
FINDERS = [(re.compile(r"(?<![\w-])(?:" + words.replace(" ", GAP) + r")(?![\w-])", re.IGNORECASE), say)
           for words, say in WORDS.items()]
IN_CODE_FONT = re.compile(r"`[^`\n]*`")                  # names that the program prints


def texts(root):
    for name in PAGES + CODE:
        place = root / name
        for file in sorted(place.rglob("*")) if place.is_dir() else [place]:
            relative = str(file.relative_to(root))
            skipped = {"corpus", "__pycache__"} & set(file.parts) or relative in SELF
            if file.is_file() and file.suffix in TEXTS and not skipped:
                yield relative, file.read_text(encoding="utf-8")


def problems_of(name, text):
    if name.endswith(".md"):
        text = IN_CODE_FONT.sub(lambda found: "`" + "_" * (len(found[0]) - 2) + "`", text)
    for finder, say in FINDERS:
        for found in finder.finditer(text):
            yield f"{name}:{text.count(chr(10), 0, found.start()) + 1}: says '{' '.join(found[0].split())}'; write: {say}"


def main(root):
    count, found = 0, []
    for name, text in texts(root):
        count += 1
        found.extend(problems_of(name, text))
    if not count:
        print(f"{root}: no texts found; is the path right?")
        return 1
    print("\n".join(found) or f"{count} texts use the words of the field")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()))
