#!/usr/bin/env python3
"""Collect the texts of all messages from the source; the build passes them to `straytrace explain`.

Usage: make_messages.py [--output FILE] [ROOT]

A message is a problem or warning about a place in a file (what, remedy) or an InputError(what, remedy).
Without --output it only checks, and fails for a message without a remedy that reads.
"""
import json
import pathlib
import re
import sys

CALL = re.compile(r"(?<![\w:])(?:(?:[\w\]\[\"\.\(\)]+(?:\.|->))?(problem|file_problem|warning|refuse|lack)|(InputError))(\(|\{)")
FORMAT = "fmt::format("
WORD = re.compile(r"[A-Za-z]{2}")
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
ABOUT = {"scene": "the scene file: docs/reference/scene.md", "world": "what stands in the scene: docs/reference/scene.md",
         "motion": "motion: docs/reference/scene.md#bodies", "ifo": "the detector: docs/reference/interferometer.md",
         "base": "values and units: docs/reference/scene.md#quantities", "geometry": "shapes: docs/reference/index.md#shapes",
         "io": "values and units: docs/reference/scene.md#quantities", "noise": "noise: docs/reference/scene.md#noise",
         "spectra": "records and spectra: docs/reference/signal.md", "results": "run files: docs/reference/run_file.md",
         "session": "commands: docs/reference/commands.md", "cli": "commands: docs/reference/commands.md",
         "analysis": "measurements: docs/reference/couple.md", "results/budget": "commands: docs/reference/commands.md"}


def closing(text, at):
    """The end of the bracket that opens at `at`, and the commas of the same level."""
    depth, commas, i, pairs = 0, [], at, {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}
    while i < len(text):
        if hit := (LITERAL.match(text, i) if text[i] == '"' else None):
            i = hit.end()
            continue
        depth += pairs.get(text[i], 0)
        if depth == 0:
            return i, commas
        if depth == 1 and text[i] == ",":
            commas.append(i)
        i += 1
    return len(text), commas


def without_values(argument):
    """The argument with the texts of `fmt::format` alone: what is inserted into them is left out."""
    at = 0
    while (at := argument.find(FORMAT, at)) >= 0:
        at += len(FORMAT)
        end, commas = closing(argument, at - 1)
        argument = argument[:commas[0] if commas else end] + argument[end:]
    return argument


def said(argument):
    """The text of an argument; inserted values become `...`, alternative texts follow `; or: `."""
    formatted, argument = FORMAT in argument, without_values(argument)
    together = re.compile(LITERAL.pattern + r'\s*(?=")')    # adjacent literals are one
    while hit := together.search(argument):
        argument = argument[:hit.end(1)] + argument[hit.end() + 1:]
    argument = re.sub(r'"\s*\+[^"?:]+\+\s*"', "...", argument)    # "known: " + names + "; write one"
    parts = [t for t in LITERAL.findall(argument) if len(t) > 2 and not re.fullmatch(r"[a-z_]+", t)]
    if formatted:
        parts = [re.sub(r"\{[^{}]*\}", "...", t.replace("{{", "\0").replace("}}", "\1")) for t in parts]
        parts = [t.replace("\0", "{").replace("\1", "}") for t in parts]
    texts = [re.sub(r"(\.\.\.){2,}", "...", t).strip() for t in parts if WORD.search(t)]
    texts = [re.sub(r"^\.\.\.(?=\w)", "", t) + (" ..." if t.endswith(":") else "") for t in texts]
    return "; or: ".join(texts).replace("?; ", "? ").replace('\\"', '"').replace("\\n", "\n")


def suggesting(text):
    """did_you_mean(word, words, otherwise) as the two texts that it chooses from."""
    while (at := text.find("did_you_mean(")) >= 0:
        end, commas = closing(text, text.index("(", at))
        text = text[:at] + text[commas[-1] + 1:end] + " : fmt::format(\"did you mean '{}'?\", near)" + text[end + 1:]
    return text


def messages_of(file, room):
    text = file.read_text(encoding="utf-8")
    text = suggesting(re.sub(r"//[^\n]*", "", text))
    for call in CALL.finditer(text):
        open_at = call.end() - 1
        end, commas = closing(text, open_at)
        ends = [*commas, end]
        arguments = [text[a:b] for a, b in zip([open_at + 1, *(c + 1 for c in commas)], ends)]
        if call.group(2):
            if call.group(3) == "(" and len(arguments) <= 2:
                yield from thrown(arguments[0], arguments[1] if len(arguments) == 2 else "", room)
            continue
        kind = call.group(1)
        if len(arguments) == {"problem": 2, "warning": 2, "lack": 3, "file_problem": 5}.get(kind):
            what, remedy = said(arguments[-2]), arguments[-1]
            if what:
                variable = not LITERAL.search(remedy) and bool(re.search(r"[a-z]", remedy))
                yield {"severity": "warning" if kind == "warning" else "error", "what": what,
                       "remedy": "as the message says" if variable else said(remedy), "about": ABOUT[room]}


def thrown(what, remedy, room):
    if what.strip().startswith("fmt::format("):      # its words, not what is put in
        what = "fmt::format(" + what[: closing(what, what.index("("))[1][0]].split("(", 1)[1]
    what, words = said(what), said(remedy)
    if not words and re.search(r"[a-z]", remedy):    # a variable or a function
        words = "as the message says"
    if what and not re.fullmatch(r"(\.\.\.|--[\w-]+)(: \.\.\.)?", what):
        yield {"severity": "error", "what": what, "remedy": words, "about": ABOUT[room]}


def collected(root):
    found = []
    for file in sorted((root / "src").rglob("*.cpp")):
        parts = file.relative_to(root / "src").parts
        room = "/".join(parts[:2]) if "/".join(parts[:2]) in ABOUT else parts[0]
        if room in ABOUT:
            found += [m | {"file": str(file.relative_to(root))} for m in messages_of(file, room)]
    return sorted(found, key=lambda m: (m["file"], m["what"]))


def main(root, output):
    found = collected(root)
    if output:
        told = [{k: v for k, v in m.items() if k != "file"} for m in found]
        pathlib.Path(output).write_text(json.dumps(told, indent=0, ensure_ascii=False) + "\n", encoding="utf-8")
        return 0
    wrong = [f"{m['file']}: '{m['what']}' has no remedy" for m in found if not m["remedy"]]
    wrong += [f"{m['file']}: the remedy of '{m['what']}' does not read: {m['remedy']}" for m in found
              if m["remedy"] and (not WORD.search(m["remedy"]) or "{}" in m["remedy"])]
    wrong += [f"{m['file']}: '{m['what']}' ends with a full stop" for m in found if m["what"].endswith(".")
              and not m["what"].endswith("...")]
    if len(found) < 300:
        wrong.append(f"only {len(found)} messages were found; is the pattern right?")
    print("\n".join(wrong) or f"{len(found)} messages, each with a remedy")
    return 1 if wrong else 0


if __name__ == "__main__":
    words = sys.argv[1:]
    into = words.pop(words.index("--output") + 1) if "--output" in words else None
    words = [w for w in words if w != "--output"]
    sys.exit(main(pathlib.Path(words[0] if words else pathlib.Path(__file__).parents[1]).resolve(), into))
