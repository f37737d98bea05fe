"""Keys that the readers request, as `straytrace print --format json` reports them: tables by their name in messages
("contexts"), their keys, and for each key every way in which it was read and written."""
import json
import pathlib
import re
import subprocess

import yaml

# A role that contains a name of the user, as "beam 'arm'".
NAMED = re.compile(r"^(beam|port|receiver|sensor|material|medium|body|mode|part|scene entry|the limits of|the motion of body|"
                   r"the responses of port|a face that uses part|parameter|component|read-out) '.*'$", re.S)
WORDS = "schema/words.yaml"
PAGES = {"BSDF model": "scatter", "shape": "shapes"}
CLOSED_FORMS = "fabry-perot-michelson"
KINDS = ("asd", "series", "csd", "power-law", "peterson", "line", "sine", "drift", "from", "like", "same_as")


class Slot:
    """All that was seen of one key, of the elements of a list, or of the values under names of the user."""

    def __init__(self):
        self.asked, self.scalars, self.tables, self.shapes = [], [], set(), {}
        self.named = self.elements = None
        self.examples = []

    def docs(self):
        return {a["doc"] for a in self.asked if "doc" in a}

    def concrete(self):
        return [a for a in self.asked if a["type"] != "named"]


def context_of(role, parent, key):
    if role.startswith("interferometer '"):
        return "interferometer" if CLOSED_FORMS in role else "interferometer by the network solver"
    if key == "faces" or parent == "faces":
        return "a face that uses part" if role.startswith("a face that") else "a face"
    hit = NAMED.match(role)
    if hit and hit.group(1) == "port" and parent.startswith("interferometer"):
        return "port of an interferometer"
    if hit:
        return hit.group(1)
    if role == parent:                       # the table under the key that names a motion
        return f"the numbers of {role}"
    if role.startswith("'") and key and role != f"'{key}'" and "/" in role:
        return "a face"
    return role


def flow(node):
    """As one would write it, in one line."""
    if "keys" in node:
        return "{" + ", ".join(f"{k['key']}: {flow(k)}" for k in node["keys"] if k["from"] != "default") + "}"
    if "elements" in node:
        return "[" + ", ".join(map(flow, node["elements"])) + "]"
    text = node.get("written", node.get("value", ""))
    return json.dumps(text) if re.search(r"[,:{}\[\]#*]|^$", text) else text


class Facts:
    def __init__(self):
        self.contexts = {}       # context -> key -> Slot
        self.occurrences = {}    # context -> how many tables were seen
        self.given = {}          # (context, key) -> in how many of them it was written
        self.first = {}          # (context, key) -> scene and keys from its top, where it was written first

    def of_scene(self, program, scene):
        done = subprocess.run([program, "print", "--quiet", "--format", "json", scene], capture_output=True, text=True)
        if done.returncode:
            raise ValueError(f"{scene}: {done.stderr}")
        told = json.loads(done.stdout)
        self.table(told["model"], "a model", (scene,))
        for placed in told["placed"]:
            if placed["face"].get("role", "").startswith("'"):
                self.table(placed["face"], "a face", ())
        return self

    def table(self, node, context, place):
        keys = self.contexts.setdefault(context, {})
        self.occurrences[context] = self.occurrences.get(context, 0) + 1
        for child in node["keys"]:
            slot = keys.setdefault(child["key"], Slot())
            slot.asked.append(child["asked"])
            if child["from"] == "default":
                continue
            self.given[context, child["key"]] = self.given.get((context, child["key"]), 0) + 1
            here = (*place, child["key"]) if place else ()
            self.first.setdefault((context, child["key"]), here)
            slot.examples.append(flow(child))
            self.value(child, slot, context, child["key"], here)

    def value(self, node, slot, context, key, place):
        if "keys" in node:
            if node.get("role"):
                inner = context_of(node["role"], context, key)
                slot.tables.add(inner)
                self.table(node, inner, place)
            else:
                for child in node["keys"]:
                    if child["from"] == "default":
                        continue
                    here = (*place, child["key"]) if place else ()
                    one_of_ours = child.get("role", "").endswith(f"shape '{child['key']}'")
                    if one_of_ours:
                        slot.shapes[child["key"]] = child["role"]
                        self.table(child, child["role"], here)
                    else:
                        slot.named = slot.named or Slot()
                        self.value(child, slot.named, key if key == "faces" else context, key, here)
                        slot.named.asked.append(child["asked"])
        elif "elements" in node:
            slot.elements = slot.elements or Slot()
            for i, child in enumerate(node["elements"]):
                self.value(child, slot.elements, context, key, (*place, i) if place else ())
        else:
            slot.scalars.append(node["asked"])

    def tidy(self):
        """Without keys that are read only to report an error, and without 'override', which every definition may have."""
        for keys in self.contexts.values():
            keys.pop("override", None)
        del self.contexts["a model"]["scan"]
        for link in ("mode", "pendulum", "resonance"):
            self.contexts.get("a transfer function", {}).pop(link, None)
        for root in ("file", "gain", "poles", "zeros"):
            self.contexts.get("a link of a chain", {}).pop(root, None)
        for kind in KINDS:
            keys = self.contexts.get(f"motion '{kind}'", {})
            for other in KINDS:
                if other != kind and other in keys and not keys[other].concrete():
                    del keys[other]
        return self


def number(value):
    return f"{value:.10g}"


def in_unit(value, unit):
    return f"{number(value)} {'rad' if unit == 'deg' and value else unit}".replace(" 1/", " /").strip()


def kind_of(asked):
    """The type in words."""
    kind = asked["type"]
    if kind in ("number", "whole", "amplitude", "numbers"):
        name = "whole number" if kind == "whole" else asked["dimension"]
        unit = f" ({asked['units']})"
        name += unit if kind != "whole" and asked["dimension"] != "plain number" and not name.endswith(unit) else ""
        name += ", with peak, pp or rms" if kind == "amplitude" else ""
        return f"{asked['count']} values: {name}" if kind == "numbers" else name
    return {"choice": "one of " + ", ".join(asked.get("choices", [])), "switch": "on or off", "word": "text",
            "table": "table", "list": "one or a list", "quantity": "quantity with its unit"}[kind]


def range_of(asked):
    low, high, unit = asked.get("low"), asked.get("high"), asked.get("unit", "")
    if low is None and high is None:
        return ""
    return f"{'' if low is None else in_unit(low, unit)} .. {'' if high is None else in_unit(high, unit)}".strip()


def samples(root):
    return sorted((pathlib.Path(root) / "schema" / "samples").glob("*.yaml"))


def words_of(root, facts):
    """What each key means, by table: schema/words.yaml, and what the code says of the numbers of shapes and BSDF models."""
    words = yaml.safe_load((pathlib.Path(root) / WORDS).read_text(encoding="utf-8"))
    common = words.pop("BSDF model")["keys"]
    for context, keys in facts.contexts.items():
        family = re.fullmatch(r"(BSDF model|shape) '([\w-]+)'", context)
        if family:
            kind, name = family.groups()
            entry = {"name": name, "about": f"the {kind} {name}", "page": f"{PAGES[kind]}/{name}.md"} | words.get(context, {})
            told = {key: doc for key, slot in keys.items() for doc in slot.docs()}
            twice = sorted(told.keys() & entry.get("keys", {}).keys())
            if twice:
                raise ValueError(f"{WORDS}: the code describes {', '.join(twice)} of '{context}'")
            words[context] = entry | {"keys": (common if kind == "BSDF model" else {}) | entry.get("keys", {}) | told}
    return words


def facts_of(program, scenes):
    facts = Facts()
    for scene in scenes:
        facts.of_scene(program, scene)
    return facts.tidy()
