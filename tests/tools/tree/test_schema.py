#!/usr/bin/env python3
"""The schema of the language against the readers, both ways. Usage: test_schema.py PROGRAM"""
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import jsonschema
import yaml

ROOT = pathlib.Path(__file__).parents[3]
sys.path.insert(0, str(ROOT / "tools"))
from keys_of_readers import Facts, facts_of, samples, words_of   # noqa: E402

SCHEMA = json.loads((ROOT / "schema/straytrace-1.schema.json").read_text(encoding="utf-8"))
BLOCK = re.compile(r"^```yaml\n(straytrace:.*?)^```$", re.MULTILINE | re.DOTALL)
# Keys as the source writes them: t.number("tis", ...), law["file"], {"arm_length", &P::arm_length, ...}.
ASKED = re.compile(r'\b\w+(?:\.|->)(?:number|whole|amplitude|word|choice|flag|table|list|has)\("([a-z][\w-]*)"')
ROW = re.compile(r'^\s*\{"([a-z]\w*)", (?:&\w+(?:<\w+>)?::\w+, )?(?:dim::|Dimension)', re.MULTILINE)
READERS = ("src/world/build/*.cpp", "src/motion/*.cpp", "src/ifo/*.cpp", "src/scene/instances.cpp", "src/noise/project/project.cpp",
           "src/noise/fundamental/budget.cpp", "src/spectra/filters.cpp", "src/trace/**/*.cpp", "src/session/model.cpp",
           "src/session/light/ghost_search.cpp", "src/geometry/**/*.cpp", "src/optics/scatter/*.cpp")
NOT_KEYS = {"scan"}          # an error with a hint, src/session/model.cpp


class Loader(yaml.SafeLoader):
    """As editors read YAML: version 1.2, where `on` is a word and 1e-6 a number."""
    yaml_implicit_resolvers = {}


Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(?:true|false)$"), list("tf"))
Loader.add_implicit_resolver("tag:yaml.org,2002:int", re.compile(r"^[-+]?[0-9]+$"), list("-+0123456789"))
Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(
    r"^[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?$"), list("-+0123456789."))
Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))
Loader.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(node.value))

VALIDATOR = jsonschema.Draft7Validator(SCHEMA)


def complaints(text):
    return [f"{'/'.join(map(str, e.absolute_path))}: {e.message[:200]}"
            for e in VALIDATOR.iter_errors(yaml.load(text, Loader=Loader))]


def scenes():
    """Everything that is a valid scene or file of motion in examples, tests, samples and documents."""
    for folder in ("examples", "library", "tests/scenes", "schema/samples"):
        for file in sorted((ROOT / folder).rglob("*.yaml")):
            yield str(file.relative_to(ROOT)), file.read_text(encoding="utf-8")
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
            yield str(page.relative_to(ROOT)), block.group(1)


def of_valid_scenes():
    count = 0
    for name, text in scenes():
        count += 1
        for complaint in complaints(text):
            yield f"the schema rejects a valid scene: {name}: {complaint}"
    if count < 40:
        yield f"only {count} scenes were found"


SCENE = """straytrace: 1
materials: {m: {scatter: {model: lambertian, tis: 1 %}}}
bodies: {b: {motion: {z: {sine: {amplitude: 1 um peak, frequency: 1 Hz}}, others: still}}}
scene:
  - {name: plate, shape: {disk: {outer_radius: 10 cm}}, side: front, body: b, material: m}
  - {name: lens, use: lens, diameter: 1 cm, at: [0 m, 0 m, 1 m], body: b, material: m}
beams: {spot: {on: plate, radius: 1 cm, emits: on}}
interferometer: {preset: adv, arm_length: 3 km}
trace: {seed: 1}
"""
BROKEN = (   # a misspelt key, a wrong choice, a missing unit, at every depth
    ("materials:", "materiels:"), ("tis:", "tiss:"), ("model: lambertian", "model: lambert"), ("motion:", "moton:"),
    ("frequency:", "freqency:"), ("1 um peak", "1"), ("10 cm", "10"), ("outer_radius", "outer_radus"), ("disk:", "disc:"),
    ("side: front", "side: frnt"), ("diameter: 1 cm", "diametre: 1 cm"), ("emits: on", "emits: maybe"),
    ("preset: adv", "preset: avd"), ("3 km", "3000"), ("seed:", "sed:"), ("seed: 1", "seed: -1"), ("others: still", "others: stil"),
    ("sine:", "sin:"), ("straytrace: 1", "straytrace: 2"), ("{model: lambertian, ", "{"), ("material: m}\n  - {name: lens", "materail: m}\n  - {name: lens"))


def of_broken_scenes():
    if found := complaints(SCENE):
        yield f"the scene that the test breaks is itself an error: {found}"
    for right, wrong in BROKEN:
        if SCENE.count(right) < 1 or not complaints(SCENE.replace(right, wrong, 1)):
            yield f"'{wrong}' in place of '{right}' passes the schema"


def keys_of(schema):
    found = set()
    for definition in [SCHEMA, *schema["$defs"].values()]:
        found |= set(definition.get("properties", {}))
        for inner in definition.get("properties", {}).values():
            for option in [inner, *inner.get("anyOf", [])]:
                found |= set(option.get("properties", {}))
    return found


def of_source():
    """The schema contains every key in the source of the readers, whether a sample reads it or not."""
    known, seen = keys_of(SCHEMA) | NOT_KEYS, 0
    for pattern in READERS:
        for file in sorted(ROOT.glob(pattern)):
            text = file.read_text(encoding="utf-8")
            for key in set(ASKED.findall(text)) | set(ROW.findall(text)):
                seen += 1
                if key not in known:
                    yield f"{file.relative_to(ROOT)}: the key '{key}' is not in the schema: use it in schema/samples"
    if seen < 250:
        yield f"only {seen} keys were found in the source; is the pattern right?"


def of_other_scenes(program):
    """The readers ask the documents' scenes for nothing that the samples did not show."""
    facts = Facts()
    with tempfile.TemporaryDirectory() as place:
        examples = pathlib.Path(place) / "examples"
        examples.symlink_to(ROOT / "examples")
        for file in sorted((ROOT / "examples").glob("*.yaml")):
            facts.of_scene(program, str(file))
    facts.tidy()
    parts = ("scene entry", "a face that uses part", "'surfaces'")      # may hold parameters and faces of own parts
    words = words_of(ROOT, facts)
    for context, keys in facts.contexts.items():
        for key in keys:
            if context not in parts and key not in words.get(context, {"keys": ()})["keys"]:
                yield f"readers ask for '{key}' of '{context}', which no sample has"


def without(model, path):
    """The model without the entry at the path; None where it has none."""
    copy = json.loads(json.dumps(model))
    node = copy
    for step in path[:-1]:
        node = node[step] if isinstance(node, list) and isinstance(step, int) else node.get(step) if isinstance(node, dict) else None
    if not isinstance(node, dict) or path[-1] not in node:
        return None
    del node[path[-1]]
    return copy


def part_of(model, path):
    """The context that a key needs: of the many materials, whose tables take seconds, only its own."""
    if path[0] != "materials":
        return model
    kept = {key: model[key] for key in ("straytrace", "params", "media") if key in model}
    return kept | {"materials": {path[1]: model["materials"][path[1]]}, "bodies": {"b": {"motion": "still"}},
                   "scene": [{"name": "s", "shape": {"disk": {"outer_radius": "1 cm"}}, "body": "b", "material": path[1]}],
                   "beams": {"l": {"on": "s", "radius": "1 mm"}}, "receivers": {"r": {"on": "s"}}}


def scenes_without(first, is_meant):
    """(key, context, sample, its text without the key) of the keys that are meant."""
    for context, definition in SCHEMA["$defs"].items():
        for key, schema in definition.get("properties", {}).items():
            scene, *path = first.get((context, key)) or (None,)
            left = scene and is_meant(schema.get("x-straytrace", {})) and \
                without(part_of(yaml.load(scene.read_text(encoding="utf-8"), Loader=Loader), path), path)
            if left:
                yield key, context, scene.name, yaml.safe_dump(left, sort_keys=False, width=1000)


def that_pass(program, cases):
    """Those of them that the program takes."""
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place) / "schema/samples"
        folder.mkdir(parents=True)
        (pathlib.Path(place) / "examples").symlink_to(ROOT / "examples")
        (folder / "data").symlink_to(ROOT / "schema/samples/data")

        def passes(case):
            scene = folder / f"{case[0]}.yaml"
            scene.write_text(case[1][-1], encoding="utf-8")
            return subprocess.run([program, "check", "--quiet", str(scene)], capture_output=True).returncode != 2

        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return [case for case, passed in zip(cases, pool.map(passes, enumerate(cases))) if passed]


def of_required_keys(program):
    """A sample without a required key is an error; without a key that has a default it is not."""
    first = facts_of(program, samples(ROOT)).first
    required = list(scenes_without(first, lambda about: about.get("default") == "required"))
    for key, context, sample, _ in that_pass(program, required):
        yield f"'{key}' of '{context}' is called required, and {sample} passes without it"
    if len(required) < 50:
        yield f"only {len(required)} required keys were tried"
    controls = list(scenes_without(first, lambda about: about.get("default", "required") != "required"))[::10]
    if len(that_pass(program, controls)) < len(controls) / 2 or len(controls) < 10:
        yield "control: keys with a default pass for required ones"


def main(program):
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    made = subprocess.run([sys.executable, ROOT / "tools/make_schema.py", "--check", program], capture_output=True, text=True)
    found = [made.stdout + made.stderr] if made.returncode else []
    found += [*of_valid_scenes(), *of_broken_scenes(), *of_source(), *of_other_scenes(program), *of_required_keys(program)]
    print("\n".join(found) or f"{len(BROKEN)} broken scenes are errors, all valid ones pass, and the schema has every key")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
