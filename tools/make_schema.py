#!/usr/bin/env python3
"""Write the JSON Schema of the scene language and the page of its keys from what the readers ask for.

Usage: make_schema.py [--check] PROGRAM [ROOT]

The readers are watched while they read schema/samples/*.yaml, which use every key; schema/words.yaml, and for the numbers
of shapes and BSDF models the code itself, says what each key means. A key that only one of the two knows is an error. --check writes nothing and fails when a file is out of date.
"""
import json
import pathlib
import re
import sys

import yaml

from keys_of_readers import KINDS, WORDS, facts_of, in_unit, kind_of, range_of, samples, words_of

SCHEMA, PAGE = "schema/straytrace-1.schema.json", "docs/reference/keys.md"
ANY_SCALAR = ["string", "number", "boolean"]
# A quantity holds a unit or a parameter, so a letter; only 0 may be bare. Expressions are left to the program.
QUANTITY = {"anyOf": [{"type": "string", "pattern": "[A-Za-zµ°%]|^[-+*/(). 0]+$"}, {"const": 0}]}
SWITCH = {"enum": ["on", "off", "yes", "no", "true", "false", True, False]}
LAWS, MOTION, ENTRY = "BSDF model", "motion", "scene entry"


def scalar_schema(asked):
    kind = asked["type"]
    if kind == "choice":
        return {"enum": asked["choices"]}
    if kind == "switch":
        return SWITCH
    if kind in ("amplitude", "number") and asked["dimension"] != "plain number":
        return QUANTITY
    if kind in ("number", "whole"):
        bare = {"type": "number"}
        bare |= {"minimum": asked["low"]} if "low" in asked else {}
        bare |= {"maximum": asked["high"]} if "high" in asked else {}
        return {"anyOf": [bare, {"type": "string"}]}
    return {"type": ANY_SCALAR}


class Maker:
    def __init__(self, facts, words, parts):
        self.facts, self.words, self.parts = facts, words, parts
        own = {key for part in parts.values() for key in part}
        entry = facts.contexts[ENTRY]
        self.place = {key for key in entry if key in words["a face"]["keys"] or
                      key in ("name", "repeat", "split", "units", "smooth", "surfaces", "imperfections", "override")}
        for context in (ENTRY, "a face that uses part"):
            for key in list(facts.contexts[context]):    # of parts that the samples define
                if key not in own | self.place:
                    del facts.contexts[context][key]

    def complaints(self):
        known = {(c, k) for c, keys in self.facts.contexts.items() for k in keys}
        told = {(c, k) for c, entry in self.words.items() for k in entry["keys"]}
        for context, key in sorted(known - told):
            yield f"{WORDS}: '{key}' of '{context}' has no words"
        for context, key in sorted(told - known):
            yield f"{WORDS}: no reader asks for '{key}' of '{context}' in {len(samples(ROOT))} samples"
        for context, key in sorted(known & told):
            unseen = not self.facts.contexts[context][key].examples
            if unseen and not self.told_elsewhere(context, key):
                yield f"schema/samples: none uses '{key}' of '{context}', so its type is not known"

    def told_elsewhere(self, context, key):
        return bool(self.slot(context, key).concrete() or self.slot(context, key).examples)

    def slot(self, context, key):
        """That of a sister table (another BSDF model, another motion) where this one does not use the key."""
        slot = self.facts.contexts[context][key]
        family = next((f for f in ("BSDF model '", "motion '", "a face") if context.startswith(f)), None)
        if slot.examples or slot.concrete() or not family:
            return slot
        sisters = [keys[key] for c, keys in self.facts.contexts.items() if c.startswith(family) and key in keys]
        sisters += [self.facts.contexts[ENTRY][key]] if family == "a face" and key in self.facts.contexts[ENTRY] else []
        return next((s for s in sisters if s.examples), slot)

    def required(self, context, key):
        slot = self.facts.contexts[context][key]
        every = self.facts.given.get((context, key), 0) == self.facts.occurrences[context]
        return every and bool(slot.concrete()) and all(a.get("required") for a in slot.concrete())

    def facts_in_words(self, context, key):
        asked = self.slot(context, key).concrete()
        if len({a["count"] for a in asked if a["type"] == "numbers"}) > 1:      # a list as long as the user makes it
            asked = [a | {"count": "several"} if a["type"] == "numbers" else a for a in asked]
        told = {"type": " or ".join(dict.fromkeys(map(kind_of, asked))), "range": "", "default": ""}
        for a in asked:
            told["range"] = told["range"] or range_of(a)
        defaults = {in_unit(a["default"], a.get("unit", "")) if isinstance(a["default"], (int, float)) else a["default"]
                    for a in asked if "default" in a}
        if len(defaults) == 1:
            told["default"] = defaults.pop()
        elif defaults:
            told["default"] = "depends on other keys"
        elif self.required(context, key):
            told["default"] = "required"
        return told

    def value_schema(self, slot):
        options = []
        for asked in slot.concrete():
            if asked["type"] in ("table", "list", "numbers"):
                continue
            options.append(scalar_schema(asked))
        if any(c.startswith(("motion '", "the motion of")) for c in slot.tables):
            options.append({"const": "still"})
        elif slot.scalars and not options:
            concrete = [a for a in slot.scalars if a["type"] in ("number", "amplitude")]
            options += map(scalar_schema, concrete)
            options += [{"type": ANY_SCALAR}] if len(concrete) < len(slot.scalars) else []
        options += self.table_schemas(slot)
        lists = [a for a in slot.concrete() if a["type"] == "list"]
        if slot.elements:
            one = self.value_schema(slot.elements)
            counts = {a["count"] for a in slot.concrete() if a["type"] == "numbers"}
            array = {"type": "array", "items": one}
            array |= {"minItems": min(counts), "maxItems": max(counts)} if len(counts) == 1 else {}
            options += [array] + ([one] if lists else [])
        elif lists and options:
            options.append({"type": "array", "items": {"anyOf": list(options)}})
        unique = [o for i, o in enumerate(options) if o not in options[:i]]
        return {} if not unique else unique[0] if len(unique) == 1 else {"anyOf": unique}

    def table_schemas(self, slot):
        options = []
        groups = {LAWS: "BSDF model '", MOTION: "motion '", "interferometer": "interferometer"}
        for context in sorted(slot.tables):
            group = next((g for g, start in groups.items() if context.startswith(start)), context)
            options.append({"$ref": f"#/$defs/{group}"})
        if slot.shapes:
            options.append({"$ref": "#/$defs/shape"})
        if slot.named:
            inner = self.value_schema(slot.named)
            options.append({"type": "object", "additionalProperties": inner, "properties": {"override": SWITCH}})
        return options

    def property(self, context, key):
        schema = dict(self.value_schema(self.slot(context, key)))
        told, entry = self.facts_in_words(context, key), self.words[context]
        text = entry["keys"][key]
        details = [told["type"], told["range"] and f"range {told['range']}", told["default"] and f"default {told['default']}"]
        hover = "; ".join(d for d in details if d).replace("default required", "required")
        schema["description"] = f"{text}\n\n{hover}" if hover else text
        examples = [e for e in self.slot(context, key).examples if len(e) <= 100]
        about = {k: v for k, v in told.items() if v} | {"page": f"docs/reference/{entry['page']}"}
        about["example"] = f"{key}: {examples[0]}" if examples else ""
        asked = self.slot(context, key).concrete()
        about["choices"] = next((a["choices"] for a in asked if "choices" in a), [])
        schema["x-straytrace"] = {k: v for k, v in about.items() if v}
        return schema

    def definition(self, context):
        keys = self.facts.contexts[context]
        out = {"type": "object", "title": self.words[context]["name"], "description": self.words[context]["about"],
               "properties": {key: self.property(context, key) for key in sorted(keys)}, "additionalProperties": False}
        needed = [key for key in sorted(keys) if self.required(context, key)]
        return out | ({"required": needed} if needed else {})

    def schema(self):
        defs = {c: self.definition(c) for c in sorted(self.facts.contexts) if c != "a model"}
        for named in ("material", "medium", "body", "part", "beam", "port", "receiver", "sensor", "parameter"):
            defs[named]["properties"]["override"] = SWITCH
        for single in ("'edges'", "'wave'", "'ghosts'", "'trace'", "'noise'", "'report'"):
            defs[single]["properties"]["override"] = SWITCH
        defs["'surfaces'"]["additionalProperties"] = {"type": ANY_SCALAR}
        self.families(defs)
        model = self.definition("a model")
        model["properties"] = {"straytrace": {"const": 1, "description": "format version, first"},
                               "include": {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
                                           "description": "files, relative to this one"}} | model["properties"]
        model.pop("required", None)
        return {"$schema": "http://json-schema.org/draft-07/schema#", "$id": "straytrace-1.schema.json",
                "$comment": "written by tools/make_schema.py from what the readers ask for; do not edit",
                **model, "title": "straytrace scene", "$defs": defs}

    def families(self, defs):
        """Tables distinguished by one key."""
        laws = {c[len(LAWS) + 2:-1]: c for c in defs if c.startswith(LAWS + " '")}
        defs[LAWS] = self.by_value("model", laws, "the law of scatter")
        kinds = {k: f"motion '{k}'" for k in KINDS}
        defs[MOTION] = {"type": "object", "description": "how one coordinate moves",
                        **self.chain([({"required": [k]}, c) for k, c in kinds.items()],
                                     {"required": ["asd"], "additionalProperties": False, "properties": {
                                         k: {"description": self.words[c]["about"]} for k, c in kinds.items()}})}
        shapes = {c[len("shape '"):-1]: {"$ref": f"#/$defs/{c}"} for c in defs if re.fullmatch(r"shape '\w+'", c)}
        defs["shape"] = {"type": "object", "description": "a shape by its name", "properties": dict(sorted(shapes.items())),
                         "additionalProperties": False, "minProperties": 1, "maxProperties": 1}
        solver = "interferometer by the network solver"
        closed = defs.pop("interferometer")
        presets = closed["properties"]["preset"]
        defs["interferometer by closed forms"] = closed
        alone = {"additionalProperties": False, "properties": {"preset": presets,
                                                               "responses": closed["properties"]["responses"]}}
        forms = {"properties": {"preset": {"const": "fabry-perot-michelson"}}, "required": ["preset"]}
        defs["interferometer"] = {"type": "object", "description": "stray field to strain", **self.chain(
            [(forms, "interferometer by closed forms"), ({"required": ["preset"]}, solver)], alone)}
        for context in (solver, "interferometer by closed forms"):
            defs[context]["properties"]["override"] = SWITCH
            if context == solver:
                defs[context]["required"] = ["preset"]
        self.entries(defs)

    def entries(self, defs):
        """A part of the model's own takes any parameter; that of the program only its own."""
        whole = defs[ENTRY]
        whole.pop("required", None)
        properties = whole["properties"]
        defs["keys of entries"] = {"properties": properties}
        refer = {k: {"$ref": f"#/$defs/keys of entries/properties/{k}"} for k in properties}
        place = {k: v for k, v in refer.items() if k in self.place}
        chain = []
        for part, parameters in self.parts.items():
            name = f"scene entry with part {part}"
            own = {k: self.parameter(properties[k], default) for k, default in sorted(parameters.items())}
            defs[name] = {"type": "object", "description": f"the part {part}", "properties": place | own,
                          "additionalProperties": False, "required": ["name"]}
            chain.append(({"properties": {"use": {"const": part}}, "required": ["use"]}, name))
        defs["scene entry with an own part"] = {"type": "object", "properties": place, "required": ["name"]}
        defs["scene entry without a part"] = {"type": "object", "properties": place,
                                              "additionalProperties": False, "required": ["name"]}
        chain.append(({"required": ["use"]}, "scene entry with an own part"))
        defs[ENTRY] = {"type": "object", "description": self.words[ENTRY]["about"], "title": "entry",
                       **self.chain(chain, {"$ref": "#/$defs/scene entry without a part"})}
        defs["a face that uses part"]["additionalProperties"] = True

    @staticmethod
    def parameter(schema, default):
        """Of a part: its default, and from that its kind."""
        text = schema["description"].split("\n\n")[0]
        computed = not re.fullmatch(r"-?[0-9.]+( \w+)?", default)
        unit = default.split(" ")[-1] if " " in default and not computed else ""
        kind = "computed from the others" if computed else {"deg": "angle", "": "plain number"}.get(unit, "length")
        facts = {k: v for k, v in schema["x-straytrace"].items() if k in ("page", "example", "choices")}
        facts |= {"type": kind, "page": "docs/reference/parts.md"} | ({} if computed else {"default": default})
        return schema | {"description": f"{text}\n\n{kind}" + ("" if computed else f"; default {default}"),
                         "x-straytrace": facts}

    @staticmethod
    def chain(cases, otherwise):
        for condition, name in reversed(cases):
            otherwise = {"if": condition, "then": {"$ref": f"#/$defs/{name}"}, "else": otherwise}
        return otherwise

    @staticmethod
    def by_value(key, contexts, about):
        cases = [{"if": {"properties": {key: {"const": value}}, "required": [key]},
                  "then": {"$ref": f"#/$defs/{context}"}} for value, context in sorted(contexts.items())]
        return {"type": "object", "required": [key], "properties": {key: {"enum": sorted(contexts), "description": about}},
                "allOf": cases}

    def page(self):
        lines = ["# All keys", "", "All keys of scenes and motion files, by table. [Scene language](scene.md) explains how they work together. "
                 "`straytrace explain TABLE.KEY` prints one entry.", "",
                 "`tools/make_schema.py` writes this page from the readers themselves and from `schema/words.yaml`."]
        for context in sorted(self.facts.contexts, key=lambda c: self.words[c]["name"]):
            entry = self.words[context]
            if not self.facts.contexts[context]:
                continue
            lines += ["", f"## {entry['name']}", "", f"{entry['about'][0].upper()}{entry['about'][1:]}: [page]({entry['page']}).",
                      "", "| key | type | range | default | |", "| --- | --- | --- | --- | --- |"]
            for key in sorted(self.facts.contexts[context]):
                told = self.facts_in_words(context, key)
                cells = [f"`{key}`", told["type"], told["range"], told["default"], entry["keys"][key]]
                lines.append("| " + " | ".join(c.replace("|", "\\|").replace("*", "\\*").replace("[", "\\[") for c in cells) + " |")
        return "\n".join(lines) + "\n"


def built_in_parts(root):
    parts = yaml.safe_load((root / "library/parts/builtin.yaml").read_text(encoding="utf-8"))["parts"]
    return {name: {k: str(v["value"] if isinstance(v, dict) else v) for k, v in part["params"].items()}
            for name, part in parts.items()}


def main(program, check):
    facts = facts_of(program, samples(ROOT))
    maker = Maker(facts, words_of(ROOT, facts), built_in_parts(ROOT))
    wrong = list(maker.complaints())
    if not wrong:
        for name, text in ((SCHEMA, json.dumps(maker.schema(), indent=1, ensure_ascii=False) + "\n"),
                           (PAGE, maker.page())):
            target = ROOT / name
            if target.exists() and target.read_text(encoding="utf-8") == text:
                continue
            if check:
                wrong.append(f"{name} is not what the readers say: run tools/make_schema.py {program}")
            else:
                target.write_text(text, encoding="utf-8")
    print("\n".join(wrong) or "the schema and the page of keys are what the readers ask for")
    return 1 if wrong else 0


if __name__ == "__main__":
    arguments = [word for word in sys.argv[1:] if word != "--check"]
    if not arguments:
        sys.exit(__doc__)
    ROOT = pathlib.Path(arguments[1] if len(arguments) > 1 else pathlib.Path(__file__).parents[1]).resolve()
    sys.exit(main(pathlib.Path(arguments[0]).resolve(), "--check" in sys.argv))
