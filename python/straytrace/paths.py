# SPDX-License-Identifier: BSD-3-Clause
"""The ranked routes of a run, and the language that picks some of them.

In `where` stand: via("NE_bench/*"), first(...), last(...), body(...), port(...), kind(...) with patterns of names;
h(30 Hz), the ASD of the route in 1/sqrt(Hz); rank, scatters (events S of the sequence), vertices, coupling, share, lever
(rad/m), rms_phase (rad), opl (m), resolved; numbers, also 5 %, 30 Hz and 2 km; comparisons, and, or, not. A comparison
with a number that is not resolved is never true.
"""

from __future__ import annotations

import ast
import fnmatch
import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .errors import InputError

if TYPE_CHECKING:
    import pandas

    from .curves import Noise

UNITS = {"%": 1e-2, "ppm": 1e-6, "Hz": 1.0, "kHz": 1e3, "m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3}
NUMBER = re.compile(r"(?<![\w.])(\d+\.?\d*(?:[eE][+-]?\d+)?)\s*(%|ppm\b|k?Hz\b|[mck]?m\b)")
STRING = re.compile(r"""("[^"]*"|'[^']*')""")
COMPARE: dict[type, Callable[[Any, Any], bool]] = {
    ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge, ast.Eq: operator.eq,
    ast.NotEq: operator.ne}
NUMBERS = ("rank", "scatters", "vertices", "coupling", "share", "lever", "rms_phase", "opl", "resolved")
PATTERNS = ("via", "first", "last", "body", "port", "kind")


@dataclass
class Path:
    """One route: a row of `straytrace paths`. Numbers that are not resolved are NaN."""

    rank: int
    id: str                           # stable between runs of the same model
    port: str
    sequence: str                     # "ITM·S > baffle·S > ITM·S"
    kind: str                         # scattered, ghost or edge
    resolved: bool
    why_not: str
    coupling: float                   # recoupled power fraction of the ordered path
    coupling_sigma: float
    hint: float                       # of the coupling, where it is not resolved
    C_rev: float
    share: float                      # of the resolved strain noise power
    share_sigma: float
    body: str                         # whose motion contributes most
    lever: float                      # rad/m
    rms_phase: float                  # rad
    regime: str
    opl: float                        # m, mean optical path
    vertices: int
    histories: int                    # that scored
    strain: Callable[[float], float]    # Hz to 1/sqrt(Hz)

    @property
    def objects(self) -> list[str]:
        """What the light meets, in order."""
        return [re.sub(r"(\[\d+\])?(·.*)?$", "", step.strip()) for step in self.sequence.split(">")]

    @property
    def scatters(self) -> int:
        """Events S of the sequence, the first and the last among them."""
        return sum(step.strip().endswith("·S") for step in self.sequence.split(">"))


Where = str | Callable[[Path], bool]


@dataclass
class Paths(Sequence[Path]):
    """Routes by rank."""

    rows: list[Path]

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: Any) -> Any:
        return Paths(self.rows[index]) if isinstance(index, slice) else self.rows[index]

    def __iter__(self) -> Iterator[Path]:
        return iter(self.rows)

    def where(self, which: str | Callable[[Path], bool] | None) -> Paths:
        """Those for which `which` is true."""
        if which is None:
            return self
        test = which if callable(which) else condition(which)
        return Paths([row for row in self.rows if test(row)])

    def table(self, frequencies: Sequence[float] = (10.0, 30.0, 100.0)) -> pandas.DataFrame:
        """A row per route; h at `frequencies` [Hz] in 1/sqrt(Hz), NaN outside the band and where not resolved."""
        import pandas

        names = ("id", "port", "sequence", "kind", "scatters", "coupling", "coupling_sigma", "share", "share_sigma", "body",
                 "lever", "rms_phase", "regime", "opl", "resolved", "why_not", "histories")
        columns: dict[str, list[Any]] = {name: [getattr(row, name) for row in self.rows] for name in names}
        columns |= {f"h({f:g} Hz)": [row.strain(f) for row in self.rows] for f in frequencies}
        return pandas.DataFrame(columns, index=pandas.Index([row.rank for row in self.rows], name="rank"))


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def paths_from(answer: Mapping[str, Any], noise: Noise | None, low: float, high: float) -> Paths:
    """Rows of `straytrace paths --format json`; with a band their shares in it, ranked anew."""
    curves = {curve.name: curve for curve in noise.routes} if noise is not None else {}
    shares: dict[str, tuple[float, float]] = {}
    if noise is not None and high > low:
        names = [curve.name for curve in noise.routes]
        shares = dict(zip(names, zip(*(column.tolist() for column in noise.shares(low, high)))))

    def strain_of(name: str, resolved: bool) -> Callable[[float], float]:
        curve = curves.get(name) if resolved else None
        return lambda hz: math.nan if noise is None or curve is None else float(noise.at(hz, curve))

    rows = []
    for r in answer["routes"]:
        coupling = r["coupling"] or {"value": None, "sigma": None}
        share, sigma = shares.get(r["sequence"], (_number(r["share"]["value"]), _number(r["share"]["sigma"])))
        rows.append(Path(
            rank=r["rank"], id=r["id"], port=r["port"], sequence=r["sequence"], kind=r["kind"], resolved=r["resolved"],
            why_not=r["why_not"], coupling=_number(coupling["value"]), coupling_sigma=_number(coupling["sigma"]),
            hint=_number(r["coupling_hint"]), C_rev=r["C_rev"], share=share, share_sigma=sigma, body=r["moving_body"],
            lever=_number(r["lever_rad_per_m"]), rms_phase=_number(r["rms_phase_rad"]), regime=r["regime"],
            opl=_number(r["path_length_m"]["mean"]), vertices=r["vertices"], histories=r["histories_scored"],
            strain=strain_of(r["sequence"], r["resolved"])))
    if shares:
        rows.sort(key=lambda row: -math.inf if math.isnan(row.share) else row.share, reverse=True)
        for rank, row in enumerate(rows, 1):
            row.rank = rank
    return Paths(rows)


def _refuse(text: str, what: str) -> InputError:
    return InputError(f"error: where '{text}': {what}\n  write for example 'via(\"baffle*\") and scatters == 3 and h(30 Hz) > "
                      "1e-25'")


def _plain(text: str) -> str:
    """Numbers with units as bare ones; strings stay."""
    parts = STRING.split(text)
    for i in range(0, len(parts), 2):
        parts[i] = NUMBER.sub(lambda m: repr(float(m[1]) * UNITS[m[2]]), parts[i])
    return "".join(parts)


def _matches(row: Path, what: str, pattern: str) -> bool:
    objects = row.objects
    names = {"via": objects, "first": objects[:1], "last": objects[-1:], "body": [row.body], "port": [row.port],
             "kind": [row.kind]}[what]
    return any(fnmatch.fnmatchcase(name, pattern) for name in names)


def condition(text: str) -> Callable[[Path], bool]:
    """The test that a text of `where` means. Raises InputError."""
    if not isinstance(text, str):
        raise TypeError(f"where is {text!r}; write a condition such as 'via(\"baffle*\")', or a function of a row")
    try:
        tree = ast.parse(_plain(text), mode="eval").body
    except SyntaxError as error:
        raise _refuse(text, f"this is no condition ({error.msg})") from None
    _check(tree, text)
    return lambda row: bool(_value(tree, row))


def _check(node: ast.AST, text: str) -> None:
    """InputError for what the language does not have."""
    for part in ast.walk(node):
        if isinstance(part, ast.Call):
            known = isinstance(part.func, ast.Name) and part.func.id in (*PATTERNS, "h")
            if not known or len(part.args) != 1 or part.keywords or not isinstance(part.args[0], ast.Constant):
                raise _refuse(text, f"there is no {ast.unparse(part)}")
            if isinstance(part.args[0].value, str) != (part.func.id != "h"):  # type: ignore[attr-defined]
                raise _refuse(text, f"{ast.unparse(part)}: patterns are texts, frequencies are numbers")
        elif isinstance(part, ast.Name):
            if part.id not in (*NUMBERS, *PATTERNS, "h"):
                raise _refuse(text, f"'{part.id}' is not known; there are {', '.join((*PATTERNS, 'h', *NUMBERS))}")
        elif not isinstance(part, (ast.Compare, ast.BoolOp, ast.UnaryOp, ast.Constant, ast.boolop, ast.unaryop, ast.cmpop,
                                   ast.expr_context)):
            raise _refuse(text, f"'{ast.unparse(part) if isinstance(part, ast.expr) else part}' is not part of it")


def _value(node: ast.AST, row: Path) -> Any:
    if isinstance(node, ast.BoolOp):
        parts = (_value(part, row) for part in node.values)
        return all(parts) if isinstance(node.op, ast.And) else any(parts)
    if isinstance(node, ast.UnaryOp):
        value = _value(node.operand, row)
        return not value if isinstance(node.op, ast.Not) else -value
    if isinstance(node, ast.Compare):
        values = [_value(part, row) for part in (node.left, *node.comparators)]
        known = not any(isinstance(v, float) and math.isnan(v) for v in values)
        return known and all(COMPARE[type(op)](a, b) for op, a, b in zip(node.ops, values, values[1:]))
    if isinstance(node, ast.Call):
        name, argument = node.func.id, node.args[0].value  # type: ignore[attr-defined]
        return row.strain(argument) if name == "h" else _matches(row, name, argument)
    return getattr(row, node.id) if isinstance(node, ast.Name) else node.value  # type: ignore[attr-defined]
