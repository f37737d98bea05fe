# SPDX-License-Identifier: BSD-3-Clause
"""HTML page of a network with a drawing of its light: python3 -m straytrace.plots.ifo_page network.json -o network.html"""

import argparse
import html
import json
import math
import pathlib
import sys

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 0 auto; max-width: 1100px; padding: 0 16px 40px; color: #222; background: #fff; }
h1 { font-size: 1.4em; } h2 { font-size: 1.1em; margin-top: 2em; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 10px; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap; } th { font-weight: 600; }
th.text, td.text { text-align: left; } svg { max-width: 100%; height: auto; } p { max-width: 75ch; }
svg text { font: 11px system-ui, sans-serif; } .light:hover { stroke: #d55e00; }
"""
# Direction of the light that leaves each port, for light that enters port 0 along +x; splitters turn it by twice the incidence.
MIRRORLIKE = {0: math.pi, 1: 0.0}


def leaving(component, port):
    """Angle of the light that leaves this port, relative to the orientation of the component, rad."""
    kind, turn = component["kind"], math.pi - 2 * component.get("incidence", 0)
    if kind == "splitter":
        return [math.pi, turn, 0.0, turn + math.pi][port]
    if kind in ("laser", "dump"):
        return 0.0
    return MIRRORLIKE[port]


def drawn_length(metres):
    return 70 + 22 * math.log10(1 + metres)


def placed(components, spaces):
    """Place and orientation of every component: light goes straight from one to the next, with lengths on a logarithmic scale."""
    at, turned = {}, {}
    ends = [(space, forward) for space in spaces for forward in (True, False)]
    lasers = [name for name, c in components.items() if c["kind"] == "laser"]
    for start in lasers + list(components):
        if start in at:
            continue
        lowest = max((y for _, y in at.values()), default=0)
        at[start], turned[start] = (0.0, lowest + 160 if at else 0.0), 0.0
        waiting = [start]
        while waiting:
            name = waiting.pop(0)
            for space, forward in ends:
                (one, port), (other, entry) = [tuple(space[key]) for key in (("from", "to") if forward else ("to", "from"))]
                if one != name or other in at:
                    continue
                angle = turned[name] + leaving(components[name], port)
                step = drawn_length(space["length"])
                at[other] = at[name][0] + step * math.cos(angle), at[name][1] - step * math.sin(angle)
                turned[other] = angle + math.pi - leaving(components[other], entry)
                waiting.append(other)
    return at, turned


def watts(power):
    for factor, unit in ((1e6, "MW"), (1e3, "kW"), (1, "W"), (1e-3, "mW"), (1e-6, "uW"), (1e-9, "nW")):
        if power >= 0.9995 * factor:
            return f"{power / factor:.4g} {unit}"
    return f"{power:.3g} W"


def symbol(component, x, y, angle):
    kind, degrees = component["kind"], -math.degrees(angle)
    if kind == "mirror":
        return f'<line x1="{x:.1f}" y1="{y - 15:.1f}" x2="{x:.1f}" y2="{y + 15:.1f}" stroke="#222" stroke-width="4" transform="rotate({degrees:.1f} {x:.1f} {y:.1f})"/>'
    if kind == "splitter":
        tilt = degrees - 90 + math.degrees(component.get("incidence", 0))
        return f'<line x1="{x - 18:.1f}" y1="{y:.1f}" x2="{x + 18:.1f}" y2="{y:.1f}" stroke="#222" stroke-width="3" transform="rotate({tilt:.1f} {x:.1f} {y:.1f})"/>'
    fill = {"laser": "#009e73", "modulator": "#e69f00", "isolator": "#56b4e9", "lens": "#cc79a7"}.get(kind, "#999")
    return f'<rect x="{x - 9:.1f}" y="{y - 9:.1f}" width="18" height="18" rx="3" fill="{fill}"/>'


def beside(x, y, steep, words):
    """A label above a level line, or to the left of a steep one."""
    place = f'x="{x - 9:.1f}" y="{y + 4:.1f}" text-anchor="end"' if steep else f'x="{x:.1f}" y="{y - 7:.1f}" text-anchor="middle"'
    return f'<text {place} fill="#933">{words}</text>'


def drawing(data):
    components = {c["name"]: c for c in data["components"]}
    at, turned = placed(components, data["spaces"])
    most = max((max(space["forward"], space["backward"]) for space in data["spaces"]), default=0) or 1
    parts = []
    for space in data["spaces"]:
        (x1, y1), (x2, y2) = at[space["from"][0]], at[space["to"][0]]
        power = max(space["forward"], space["backward"])
        width = 1 + 7 * max(0.0, 1 + math.log10(power / most) / 8) if power > 0 else 1
        told = (f'{space["from_port"]} to {space["to_port"]}: {space["length"]:g} m; {watts(space["forward"])} that way, '
                f'{watts(space["backward"])} back')
        parts.append(f'<line class="light" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="#c33" stroke-opacity="0.55" '
                     f'stroke-width="{width:.1f}"><title>{html.escape(told)}</title></line>')
        if power > 0 and math.hypot(x2 - x1, y2 - y1) > 60:
            parts.append(beside((x1 + x2) / 2, (y1 + y2) / 2, abs(y2 - y1) > abs(x2 - x1), watts(power)))
    for name, component in components.items():
        x, y = at[name]
        parts.append(symbol(component, x, y, turned[name]))
        parts.append(f'<text x="{x + 6:.1f}" y="{y + 30:.1f}" font-weight="600">{html.escape(name)}</text>')
    xs, ys = [x for x, _ in at.values()], [y for _, y in at.values()]
    left, top, width, height = min(xs) - 60, min(ys) - 45, max(xs) - min(xs) + 160, max(ys) - min(ys) + 95
    return (f'<svg viewBox="{left:.0f} {top:.0f} {width:.0f} {height:.0f}" width="{width:.0f}" role="img" '
            f'aria-label="network with powers">{"".join(parts)}</svg>')


COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31", "#7f7f7f")
WIDE, HIGH = 760, 300                   # of a chart, with margins of 70 left, 20 right, 12 above, 40 below
LEFT, RIGHT, TOP, BOTTOM = 70, 20, 12, 40


def decades(low, high):
    """Powers of ten in the range, at most some nine."""
    ends = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    step = max(1, -(-(ends[1] - ends[0]) // 8))
    return range(ends[0], ends[1] + 1, step)


def runs(points):
    """Pieces of a curve between values that are unknown."""
    piece = []
    for point in points:
        if point is None:
            if piece:
                yield piece
            piece = []
        else:
            piece.append(point)
    if piece:
        yield piece


def chart(hz, series, label):
    """SVG of curves {name: values} with logarithmic axes; null and zero are left out."""
    seen = [v for values in series.values() for v in values if v]
    if not seen or len(hz) < 2:
        return ""
    low, high = max(min(seen), 1e-12 * max(seen)) / 1.3, max(seen) * 1.3

    def x(f):
        return LEFT + (WIDE - LEFT - RIGHT) * math.log(f / hz[0]) / math.log(hz[-1] / hz[0])

    def y(value):
        return TOP + (HIGH - TOP - BOTTOM) * math.log(high / max(value, low)) / math.log(high / low)

    parts = [f'<rect x="{LEFT}" y="{TOP}" width="{WIDE - LEFT - RIGHT}" height="{HIGH - TOP - BOTTOM}" fill="none" stroke="#999"/>']
    for n in decades(hz[0], hz[-1]):
        parts.append(f'<line x1="{x(10.0 ** n):.1f}" x2="{x(10.0 ** n):.1f}" y1="{TOP}" y2="{HIGH - BOTTOM}" stroke="#ddd"/>'
                     f'<text x="{x(10.0 ** n):.1f}" y="{HIGH - BOTTOM + 15}" text-anchor="middle">{10.0 ** n:g}</text>')
    for n in decades(low, high):
        parts.append(f'<line x1="{LEFT}" x2="{WIDE - RIGHT}" y1="{y(10.0 ** n):.1f}" y2="{y(10.0 ** n):.1f}" stroke="#ddd"/>'
                     f'<text x="{LEFT - 6}" y="{y(10.0 ** n) + 4:.1f}" text-anchor="end">1e{n}</text>')
    for i, (name, values) in enumerate(series.items()):
        colour = "#222" if name == "total" else COLOURS[i % len(COLOURS)]
        for piece in runs([(f, v) if v else None for f, v in zip(hz, values)]):
            path = " ".join(f"{x(f):.1f},{y(v):.1f}" for f, v in piece)
            parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.6"><title>{html.escape(name)}</title></polyline>')
        parts.append(f'<text x="{LEFT + 8}" y="{TOP + 16 + 14 * i}" fill="{colour}" font-weight="600">{html.escape(name)}</text>')
    parts.append(f'<text x="{(LEFT + WIDE - RIGHT) / 2:.0f}" y="{HIGH - 6}" text-anchor="middle">frequency [Hz]</text>'
                 f'<text x="14" y="{(TOP + HIGH - BOTTOM) / 2:.0f}" text-anchor="middle" transform="rotate(-90 14 {(TOP + HIGH - BOTTOM) / 2:.0f})">'
                 f"{html.escape(label)}</text>")
    return f'<svg viewBox="0 0 {WIDE} {HIGH}" width="{WIDE}" role="img" aria-label="{html.escape(label)} over frequency">{"".join(parts)}</svg>'


def columns(rows, keys):
    return {name: [row[key] for row in rows] for name, key in keys.items()}


def charts(data):
    """Curves of the loops, and the noise of h with all loops acting."""
    found, curves = [], data.get("curves") or {}
    if rows := curves.get("suppression"):
        hz = [row["frequency"] for row in rows]
        lengths = [key.removeprefix("gain_") for key in rows[0] if key.startswith("gain_")]
        found += ["<h2>loops over frequency</h2>", f'<p>{html.escape(data["headings"]["suppression"])}</p>',
                  chart(hz, columns(rows, {name: f"gain_{name}" for name in lengths}), "open-loop gain |G|"),
                  chart(hz, columns(rows, {name: name for name in lengths}), "suppression |1/(1 + G)|")]
    if rows := curves.get("strain_noise"):
        names = [key for key in rows[0] if key != "frequency"]
        found += ["<h2>noise of h</h2>", f'<p>{html.escape(data["headings"]["strain_noise"])}</p>',
                  chart([row["frequency"] for row in rows], columns(rows, {name: name for name in names}), "h [1/sqrt(Hz)]")]
    return "".join(found)


def table(sheet):
    head = "".join(f'<th{" class=text" if text else ""}>{html.escape(title)}</th>' for title, text in zip(sheet["titles"], sheet["text"]))
    rows = "".join("<tr>" + "".join(f'<td{" class=text" if text else ""}>{html.escape(cell)}</td>' for cell, text in zip(row, sheet["text"])) + "</tr>"
                   for row in sheet["rows"])
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>' if sheet["rows"] else ""


def page(data):
    title = html.escape(data["title"])
    sheets = "".join(f'<h2>{html.escape(sheet["name"].replace("_", " "))}</h2><p>{html.escape(sheet["heading"])}</p>{table(sheet)}' for sheet in data["sheets"])
    return (f'<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>{title}</title><style>{STYLE}</style></head><body><h1>{title}</h1>"
            f'<p>Point at the light for powers in both directions. Widths are logarithmic, lengths are not to scale.</p><div class="wide">{drawing(data)}</div>'
            f"{charts(data)}{sheets}<p>straytrace {html.escape(data['version'])}</p></body></html>")


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="straytrace.plots.ifo_page", description="Writes a network as an HTML page.")
    parser.add_argument("file", metavar="network", help="network with its powers and tables, as straytrace ifo --html passes it")
    parser.add_argument("-o", "--out", default="network.html")
    options = parser.parse_args(arguments)
    try:
        data = json.loads(pathlib.Path(options.file).read_text(encoding="utf-8"))
        pathlib.Path(options.out).write_text(page(data), encoding="utf-8")
    except (OSError, ValueError, KeyError) as error:
        print(f"error: {options.file}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
