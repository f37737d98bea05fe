# SPDX-License-Identifier: BSD-3-Clause
"""The picture of a run: noise with its errors, shares of the routes, energy balance."""

import textwrap

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .bands import draw_bands
from .style import GREY, LIGHT, ROUTE_COLOURS, TERM_COLOURS, plain_number
from .words import hertz, plain, power_of_ten, shortened, told_apart

DESIGN_STYLES = ("-", (0, (8, 1.5)), (0, (3, 1, 1, 1)))
CLOSED = 1e-12  # of the emitted power: what lies below is rounding, as in report.txt
TOP = 6
FAINT = 1e-4  # of the total, at every frequency: such a route is not listed
MEASURED_COLOURS = ("#7b3294", "#8a6d00", "#b00020")
FALL = 1e-15  # of the highest total: what lies below is where a curve ends
SIZE = (16.0, 10.0)  # inches at 100 dpi: 1600 x 1000 pixels
def ranked(run, band):
    """Indices of resolved routes, loudest first, and their shares with errors."""
    share, error = run.noise.shares(*band)
    order = [i for i in np.argsort(-np.nan_to_num(share, nan=-1.0)) if np.isfinite(share[i])]
    return order, share, error


def listed_routes(noise, order):
    """The first of `order` without those that are far below the total at every frequency."""
    visible = [i for i in order[:TOP] if np.any(noise.routes[i].mean >= FAINT * noise.total.mean)]
    return visible or order[:1]


def limits(curves):
    """Logarithmic range: the first curve, and others down to 8 decades below the top or 5 below its highest value."""
    values = np.concatenate([c[np.isfinite(c) & (c > 0)] for c in curves] or [np.array([])])
    if values.size == 0:
        return 1e-26, 1e-20
    highest = np.nanmax(curves[0], initial=0)
    top, first = values.max() * 3, highest * 1e3
    low = max(values.min() / 2, min(top, first or top) * 1e-8)
    return min(low, np.min(curves[0][curves[0] > FALL * highest], initial=2 * low) / 2), top


def draw_measured(axes, measured):
    """Measured strain with its error; its values."""
    shown = []
    for curve, colour in zip(measured, MEASURED_COLOURS):
        columns = (np.array(curve[key], dtype=float) for key in ("frequency", "asd", "low", "high"))
        f, asd, low, high = columns
        axes.plot(f, asd, color=colour, lw=1.3, label=f"measured: {shortened(curve['name'], 42)}", zorder=3)
        axes.fill_between(f, low, high, color=colour, alpha=0.3, lw=0)
        shown.append(asd)
    return shown


def draw_budget(axes, run, band, measured=()):
    noise, total = run.noise, run.noise.total
    f = noise.frequency
    shown = [total.mean, total.amplitude] + ([noise.bands.speckle_95] if noise.bands else [])
    axes.plot(f, total.mean, color="black", lw=2.2, label="stray light, total" + noise.bound, zorder=5)
    low = np.maximum(total.mean - total.sigma, 1e-300)
    axes.fill_between(f, low, total.mean + total.sigma, color="black", alpha=0.25, lw=0, label="± one standard error")
    draw_bands(axes, noise)
    axes.plot(f, total.phase, color="black", lw=1.1, ls=(0, (4, 3)), label="phase quadrature alone", zorder=4)
    axes.plot(f, total.amplitude, color="black", lw=1.1, ls=(0, (1, 1.5)), label="amplitude quadrature alone", zorder=4)
    for k, (name, design) in enumerate(noise.design.items()):
        axes.plot(f, design, color=GREY, lw=2.2, ls=DESIGN_STYLES[k % len(DESIGN_STYLES)], label=name)
        shown.append(design)
        if k == 0:
            margin = f"{name} × {noise.margin:g} (margin)"
            axes.plot(f, noise.margin * design, color=GREY, lw=1.5, ls=(0, (6, 2)), label=margin)
            shown.append(noise.margin * design)
    order, _, _ = ranked(run, band)
    listed = listed_routes(noise, order)
    names = told_apart([noise.routes[i].name for i in listed], 54)
    for k, i in enumerate(listed):
        axes.plot(f, noise.routes[i].mean, color=ROUTE_COLOURS[k], lw=1.5, label=names[k])
    if len(order) > len(listed):
        axes.plot([], [], ls="none", label=f"and {len(order) - len(listed)} fainter")
    shown += [noise.routes[i].mean for i in order[:3]]
    shown += draw_measured(axes, measured)
    axes.set(xscale="log", yscale="log", xlim=(noise.edges[0], noise.edges[-1]), ylim=limits(shown))
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel(r"strain $h$ [1/$\sqrt{\mathrm{Hz}}$]")
    axes.set_title("Strain noise: one-sided amplitude spectral density, mean over static phases")
    axes.xaxis.set_major_formatter(FuncFormatter(plain_number))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_locator(LogLocator(base=10, numticks=12))
    axes.grid(True, which="major", color=LIGHT, lw=0.7)
    axes.grid(True, which="minor", axis="x", color=LIGHT, lw=0.3)
    axes.set_axisbelow(True)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0, handlelength=2.4, labelspacing=0.55)


def draw_shares(axes, run, band):
    """Bars of the share of noise power, with the coupling of each route in words."""
    order, share, error = ranked(run, band)
    listed = listed_routes(run.noise, order)
    rows = [(run.noise.routes[i].name, share[i], error[i], ROUTE_COLOURS[k], i) for k, i in enumerate(listed)]
    rest = [i for i in order if i not in listed]
    if rest:
        plural = "s" if len(rest) > 1 else ""
        rows.append((f"{len(rest)} further route{plural}", share[rest].sum(), np.sqrt(np.sum(error[rest] ** 2)), GREY, None))
    place = np.arange(len(rows))[::-1]
    axes.barh(place, [100 * r[1] for r in rows], height=0.52, color=[r[3] for r in rows],
              xerr=[100 * r[2] for r in rows], error_kw={"lw": 1.2, "capsize": 3, "ecolor": "black"})
    names = told_apart([r[0] for r in rows], 84)
    for y, name, (_, value, sigma, _, i) in zip(place, names, rows):
        words = plain(100 * value, 100 * sigma, " %") if value > 0 else "nothing moves on them"
        if i is not None:
            words += f"   coupling {power_of_ten(run.routes.coupling[i], run.routes.sigma[i], run.routes.kind[i] == 'edge')}"
        axes.annotate(words, (100 * (value + sigma), y), xytext=(6, 0), textcoords="offset points", va="center", fontsize=9.5)
        axes.annotate(name, (0, y + 0.28), xytext=(2, 0), textcoords="offset points", va="bottom", fontsize=9.5)
    widest = max([100 * (r[1] + r[2]) for r in rows], default=100)
    axes.set_xlim(0, 1.75 * widest)
    axes.set_ylim(-0.6, max(len(rows) - 0.15, 1))
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    ticks = [t for t in axes.get_xticks() if t <= min(1.1 * widest, 100)]
    axes.set_xticks(ticks)
    axes.spines["bottom"].set_bounds(0, ticks[-1])
    axes.set_xlabel("share of strain noise power [%]", x=0.5 * ticks[-1] / axes.get_xlim()[1])
    axes.set_title(f"Routes by share of noise, {hertz(band[0])} to {hertz(band[1])} Hz")
    if not rows:
        axes.text(0.5, 0.5, "no resolved route", ha="center", va="center", transform=axes.transAxes)


def draw_energy_balance(axes, run):
    """Where the emitted light went: shares of the emitted power."""
    emitted = run.energy_balance.get("emitted", (0.0, 0.0))[0]
    terms = [(name, *value) for name, value in run.energy_balance.items() if name != "emitted"]
    place = np.arange(len(terms))[::-1]
    if emitted <= 0:
        axes.text(0.5, 0.5, "no light was emitted", ha="center", va="center", transform=axes.transAxes)
        emitted = 1.0
    seen = [bool(np.isfinite(s)) for _, _, s in terms]
    values = np.array([v if ok else 0.0 for (_, v, _), ok in zip(terms, seen)]) / emitted
    errors = np.array([s if ok else 0.0 for (_, _, s), ok in zip(terms, seen)]) / emitted
    rounding = np.abs(values) < CLOSED
    errors = np.where(rounding, 0.0, errors)
    axes.barh(place, 100 * values, height=0.6, color=[TERM_COLOURS.get(n, GREY) for n, _, _ in terms],
              xerr=100 * errors, error_kw={"lw": 1.2, "capsize": 3, "ecolor": "black"})
    for y, value, error, ok, nothing in zip(place, values, errors, seen, rounding):
        if not ok:
            words = "none seen"
        elif nothing:
            words = "rounding only"
        elif abs(value) + error < 1e-6:     # of the emitted power: no digits of a per cent would be left
            words = f"{100 * value:.1g} ± {100 * error:.1g} %"
        else:
            words = plain(100 * value, 100 * error, " %")
        axes.annotate(words, (100 * max(value + error, 0), y), xytext=(6, 0), textcoords="offset points", va="center",
                      fontsize=9.5)
    axes.set_yticks(place, [n for n, _, _ in terms])
    axes.tick_params(axis="y", length=0)
    widest = 100 * max(values.max(initial=0.0), 0.01)
    axes.set_xlim(min(0.0, 100 * float(np.min(values - errors, initial=0.0))), 1.5 * widest)
    axes.set_xticks([t for t in axes.get_xticks() if 0 <= t <= min(1.2 * widest, 100)])
    axes.set_ylim(-0.6, len(terms) - 0.4)
    axes.set_xlabel("share of emitted power [%]")
    axes.set_title("Where the light went")


def receivers_only(run):
    return not run.ports and bool(run.receivers)


def strongest(run):
    """(name, value, error, whether it is an upper bound) of the strongest resolved routes, or of the receivers."""
    routes = run.routes
    rows = [(routes.name[i], routes.coupling[i], routes.sigma[i], routes.kind[i] == "edge") for i in np.flatnonzero(routes.trusted)]
    if receivers_only(run):
        rows = [(r.name, r.power, r.sigma, False) for r in run.receivers if r.trusted]
    return sorted((row for row in rows if row[1] > 0), key=lambda row: -row[1])[:12]


def draw_couplings(axes, run, rows):
    """Without noise: couplings of the strongest routes, or the light on receivers, on a logarithmic axis."""
    axes.set_title("Light on receivers" if receivers_only(run) else "Routes by coupling (noise not computed)")
    axes.set_xlabel("power over that of the main mode" if receivers_only(run) else "recoupled power fraction, ordered paths")
    coupling, sigma = np.array([r[1] for r in rows]), np.array([r[2] for r in rows])
    place = np.arange(len(rows))[::-1]
    axes.errorbar(coupling, place, xerr=sigma, fmt="o", color=ROUTE_COLOURS[0], capsize=3)
    axes.set(xscale="log", xlim=(coupling.min() / 3, coupling.max() * 30), ylim=(-0.5, len(rows) - 0.3))
    for y, (name, value, error, bound) in zip(place, rows):
        axes.annotate(shortened(name, 90), (0, y + 0.22), xycoords=("axes fraction", "data"), xytext=(4, 0),
                      textcoords="offset points", va="bottom", fontsize=9.5)
        axes.annotate(power_of_ten(value, error, bound), (value + error, y), xytext=(8, 0), textcoords="offset points",
                      va="center", fontsize=9.5)
    axes.set_yticks([])
    axes.grid(True, axis="x", color=LIGHT, lw=0.7)
    axes.set_axisbelow(True)


def listed(title, names, width):
    """The first of them, under a title; nothing without names."""
    lines = [f"{title} ({len(names)}):"] if names else []
    for name in names[:3]:
        lines += textwrap.wrap(name, width, initial_indent="  ", subsequent_indent="    ", max_lines=2, placeholder=" …")
    if len(names) > 3:
        lines.append(f"  and {len(names) - 3} more")
    return lines


def notes(run, width=62):
    """What is not in the curves, and whether it matters."""
    routes = [name for name, ok in zip(run.routes.name, run.routes.trusted) if not ok]
    if run.noise is not None:
        routes = run.noise.unresolved
    receivers = [f"{r.name}: {r.why_not}" for r in run.receivers if not r.trusted]
    unresolved = routes + receivers
    lines = listed("unresolved, in the total as observed", routes, width) + listed("unresolved receivers", receivers, width)
    if not unresolved:
        faint = len(run.noise.faint) if run.noise is not None else 0
        lines.append(f"unresolved: {faint}, too faint to matter" if faint else "unresolved: none")
    if not run.complete:
        lines.append("checkpoint: the run is not finished")
    return "\n".join(lines), bool(unresolved) or not run.complete


def footer(run):
    a = run.attributes
    motion = f"    motion {a['motion_file']}" if a.get("motion_file") else ""
    return (f"{a['program']} {a['version']} ({a['commit']})    model {a['model_hash'][:12]}    seed {int(a['seed'])}"
            f"    {int(a['histories']):,} histories    {a['created']}").replace(",", " ") + motion


def draw(run, band=None, measured=()):
    """The picture of a run; `band`: Hz, for the shares of the routes (default: all frequencies); `measured`: strain to draw over it."""
    figure = plt.figure(figsize=SIZE, dpi=100)
    figure.text(0.055, 0.962, shortened(run.attributes.get("title") or "Stray light", 110), fontsize=16, weight="bold")
    figure.text(0.055, 0.012, footer(run), fontsize=9, color=GREY)
    place, balance, width = (0.70, 0.90), (0.72, 0.085, 0.25, 0.295), 62
    rows = strongest(run) if run.noise is None else []
    if rows:
        draw_couplings(figure.add_axes((0.055, 0.085, 0.56, 0.825)), run, rows)
    elif run.noise is None:
        words = "receiver is resolved" if receivers_only(run) else "route is resolved" if run.routes.name else "route was found"
        figure.text(0.055, 0.90, f"No {words}: there is no answer yet.", fontsize=12, va="top")
        place, balance, width = (0.055, 0.86), (0.11, 0.085, 0.5, 0.5), 150
    else:
        band = band or tuple(run.noise.edges[[0, -1]])
        top = figure.add_axes((0.055, 0.455, 0.595, 0.465))
        draw_budget(top, run, band, measured)
        figure.canvas.draw()
        legend = top.get_legend().get_window_extent().transformed(figure.transFigure.inverted())
        place = (legend.x0 + 0.005, legend.y0 - 0.012)
        draw_shares(figure.add_axes((0.055, 0.085, 0.56, 0.295)), run, band)
    text, alarming = notes(run, width)
    for curve in measured if run.noise is not None else ():
        text += "\n" + "\n".join(textwrap.wrap(f"measured: {curve['source']}", width, subsequent_indent="  "))
    figure.text(*place, text, fontsize=9.5, va="top", color="#a23b00" if alarming else GREY, linespacing=1.35)
    draw_energy_balance(figure.add_axes(balance), run)
    return figure
