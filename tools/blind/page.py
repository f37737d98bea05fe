"""Writes the measured parts of docs/theory/blind.md and its pictures."""
import pathlib

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt   # noqa: E402
from scipy import stats           # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PAGE = SOURCE / "docs/theory/blind.md"
NAMES = {"coupling": "coupling", "levers": "phase sensitivities", "strain": "PSD of h"}


def replace(mark, lines):
    """Puts lines between <!-- mark --> and <!-- end -->."""
    text = PAGE.read_text(encoding="utf-8")
    begin = text.index(f"<!-- {mark} -->") + len(f"<!-- {mark} -->")
    end = text.index("<!-- end -->", begin)
    PAGE.write_text(text[:begin] + "\n\n" + "\n".join(lines) + "\n\n" + text[end:], encoding="utf-8")


def blind_lines(result, asked):
    yield (f"`scripts/validation blind --scenes {asked.scenes} --seed {asked.seed}`, {asked.histories} histories each; "
           f"{result['left_out']} routes are left out, which the oracle does not resolve to 10 %.")
    yield ""
    yield "| compared | pulls | mean | standard deviation | below 1σ (68.3 %) | below 2σ (95.4 %) | largest | p: Kolmogorov-Smirnov, χ², sum of squares | verdict |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for kind, v in result["kinds"].items():
        yield (f"| {NAMES[kind]} | {v['pulls']} | {v['mean']:.3f} | {v['deviation']:.3f} | {v['1 sigma']:.1%} | {v['2 sigma']:.1%} | "
               f"{v['largest']:.2f} | {v['Kolmogorov-Smirnov']:.2g}, {v['chi^2']:.2g}, {v['sum of squares']:.2g} (one pull of each of {v['scenes']} scenes) | "
               f"{'agrees' if v['agree'] else '**disagrees**'} |").replace("%", " %").replace("  %", " %")
    yield ""
    yield "| wrong oracle (control) | pulls | sum of their squares | |"
    yield "| --- | --- | --- | --- |"
    for control, v in result["controls"].items():
        yield f"| {control} | {v['pulls']} | {v['sum of squares']:.3g} | {'rejected' if v['rejected'] else '**not rejected**'} |"


def write_blind(pulls, result, asked):
    kinds = list(result["kinds"])
    figure, axes = plt.subplots(1, len(kinds), figsize=(10, 3.2), sharey=True, layout="constrained")
    x = np.linspace(-5, 5, 201)
    for axis, kind in zip(axes, kinds):
        values = [p["pull"] for p in pulls if p["kind"] == kind]
        axis.hist(np.clip(values, -5, 5), bins=np.linspace(-5, 5, 31), density=True, color="#9dbfd9", edgecolor="white", linewidth=0.4)
        axis.plot(x, stats.norm.pdf(x), color="#222222", linewidth=1.2)
        axis.set_title(f"{NAMES[kind]}: {len(values)} pulls", fontsize=10)
        axis.set_xlabel("(program − oracle) / error")
    axes[0].set_ylabel("density")
    figure.savefig(SOURCE / "docs/theory/blind_pulls.png", dpi=150, metadata={"Software": None})
    plt.close(figure)
    replace("blind", blind_lines(result, asked))
