# SPDX-License-Identifier: BSD-3-Clause
"""The field of a cavity at small angles as numpy arrays. Layout: /wave in schema/run-2.txt."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass
class Irradiance:
    """Light that arrives at a plane from one side, before its opening, relative to the power of the mode: means over cells of
    rings and sectors about the axis of the cavity. A ring is as wide as the pitch of the grid, so that sums over the core of the
    mode, which few rings hold, are too large by some percent."""

    plane: str                    # the object whose inner edge, or the mirror
    place: float                  # m along the axis from mirror 1
    towards: str                  # the mirror that the light goes to
    step: float                   # m, width of a ring
    mean: npt.NDArray[np.float32]         # [ring, sector], 1/m^2; times the power of the mode: W/m^2
    mean_square: npt.NDArray[np.float32]  # of its square, 1/m^4

    @property
    def radius(self) -> Array:
        """Middle of each ring [m]."""
        rings: Array = np.arange(self.mean.shape[0], dtype=np.float64) + 0.5
        return rings * self.step

    @property
    def azimuth(self) -> Array:
        """Middle of each sector [rad], from x towards y."""
        sectors: Array = np.arange(self.mean.shape[1], dtype=np.float64) + 0.5
        return sectors * (2 * np.pi / int(self.mean.shape[1]))

    @property
    def area(self) -> Array:
        """Area of a cell of each ring [m^2]."""
        return self.radius * (2 * np.pi * self.step / int(self.mean.shape[1]))

    @property
    def profile(self) -> Array:
        """Mean over the azimuth, by ring [1/m^2]."""
        return np.asarray(self.mean.mean(axis=1), dtype=float)


@dataclass
class Wave:
    """The solved cavity of the table `wave` of a scene."""

    beam: str
    power: float                  # W, of the mode; 0: not stated
    wavelength: float             # m
    length: float                 # m
    points: int                   # of the grid, along one side
    window: float                 # m, side of the grid
    crossover: float              # rad
    eigenvalue: complex           # of the round trip, without its transmissions, in the first draw of the heights
    loss: float                   # of power per round trip, mean over the draws of the heights
    loss_of_smooth_mirrors: float     # NaN: not known
    beyond_band: float
    mirrors: dict[str, Any]       # columns with one entry for each mirror: name, radius, mode_radius, lost ...
    heights: dict[str, Any]       # columns with one entry for each draw of the heights: rms, loss, at_mirrors, on_baffles,
                                  # residual, and the complex derivatives by the motion of each mirror (mirror1_displacement ...)
    modes: dict[str, Any]         # columns order, n, m, shared, p, l, shared_laguerre, loss, phase [turns], alike ...
    edges: dict[str, Any]         # columns with one entry for each inner edge, in order of place
    draw_offset: npt.NDArray[np.uint64]   # draws of edge i: from draw_offset[i] to draw_offset[i + 1]
    draws: dict[str, Any]         # columns; displacement [n, 3] 1/m and rotation [n, 3] 1/rad are complex
    irradiance: list[Irradiance]
    fields: list[npt.NDArray[np.complex64]] = field(default_factory=list)   # arriving at mirror 1 and 2, [y, x], 1/m
    at: Array | None = None       # m, x of the columns and y of the rows of `fields`; None without them
    warnings: list[str] = field(default_factory=list)
    grid_check: dict[str, Any] | None = None      # of `wave --grid-check`: changes by a finer grid
    photodiodes: dict[str, Any] | None = None     # of `wave -o`; see light_on_photodiodes
    device: str = "cpu"           # where the fields were computed
    by_frequency: dict[str, Any] | None = None    # of `wave --by-frequency`: columns from, to [1/m], scattered, loss; smooth, beyond

    def levers(self, edge: int) -> ComplexArray:
        """Derivatives of the stray field over the main field by the motion of an inner edge, [draw, 6]: x, y, z [1/m] and
        rotations about them [1/rad]. Each draw of the heights has a row for the edges as in the scene, then one for each draw of
        the tolerances and of the roll of a mirror; `draws["heights"]` and `draws["tolerance"]` number them, as draw_offset says. No row: the grid does not hold the light that meets the edge, and the columns speckle_... of `edges` stand for it."""
        part = slice(int(self.draw_offset[edge]), int(self.draw_offset[edge + 1]))
        return np.hstack([self.draws["displacement"][part], self.draws["rotation"][part]])

    def light(self, plane: str, towards: str | None = None) -> list[Irradiance]:
        """The irradiances on the planes of this name.

        towards: only of light that goes to this mirror."""
        return [i for i in self.irradiance if i.plane == plane and towards in (None, i.towards)]

    def ledger(self) -> dict[str, float]:
        """Where the power lost in a round trip goes, as shares of the power of the mode. Their sum is `loss`."""
        one, two = self.mirrors["name"]
        lost = self.mirrors["lost"]
        edges = self.edges
        return {f"past the rim of {one}, and scattered": float(lost[0]), f"past the rim of {two}, and scattered": float(lost[1]),
                f"on baffles, towards {two}": float(np.sum(edges["towards_mirror2"])),
                f"on baffles, towards {one}": float(np.sum(edges["towards_mirror1"])),
                "at angles that reach no opening": self.beyond_band}

    def table(self) -> pandas.DataFrame:
        """One row per inner edge: place [m], radius [m], angles [rad], method, power on its baffle [W, or share of the mode],
        rms of the transverse and longitudinal levers [1/m] over the draws (or as in the scene), and their expectations."""
        import pandas

        scale = self.power or 1.0
        across, along = [], []
        for i in range(len(self.edges["name"])):
            drawn, tolerance = self.levers(i), self.draws["tolerance"][int(self.draw_offset[i]):int(self.draw_offset[i + 1])]
            kept = drawn[tolerance > 0] if np.any(tolerance > 0) else drawn
            square = np.mean(np.abs(kept) ** 2, axis=0) if len(kept) else np.full(6, np.nan)
            across.append(np.sqrt((square[0] + square[1]) / 2))
            along.append(np.sqrt(square[2]))
        return pandas.DataFrame({
            "z": self.edges["centre"][:, 2], "radius": self.edges["radius"], "angle1": self.edges["angle1"],
            "angle2": self.edges["angle2"], "method": ["speckle" if np.isnan(a) else "wave" for a in across],
            "power": scale * (self.edges["towards_mirror1"] + self.edges["towards_mirror2"]), "across": across, "along": along,
            "speckle_across": np.sqrt(self.edges["speckle_across"]), "speckle_along": np.sqrt(self.edges["speckle_along"])},
            index=pandas.Index(self.edges["name"], name="edge"))

    def light_on_photodiodes(self) -> pandas.DataFrame:
        """One row per photodiode: its middle x, y [m] across the axis, area [m^2], and in W (or over the power of the mode where the
        scene does not state it) the light with the heights of the first draw (NaN: the grid does not hold it), its mean and its
        standard deviation over all heights of the mirrors that no map states. Without photodiodes no row: `straytrace wave -o` computes them."""
        import pandas

        scale, found = self.power or 1.0, self.photodiodes or {}
        centre = np.asarray(found.get("centre", np.zeros((0, 2))))
        columns: dict[str, Any] = {"x": centre[:, 0], "y": centre[:, 1], "area": found.get("area", np.zeros(0))}
        for name in ("power", "mean", "spread"):
            columns[name] = scale * np.asarray(found.get(name, np.zeros(0)))
        return pandas.DataFrame(columns, index=pandas.Index(found.get("name", []), name="photodiode"))


@dataclass
class WaveRing:
    """The solved ring or folded cavity of the table `wave` of a scene."""

    beam: str
    power: float                  # W, of the mode; 0: not stated
    wavelength: float             # m
    length: float                 # m, of the round trip
    points: int                   # of the grid, along one side
    window: float                 # m, side of the grid at the first mirror
    crossover: float              # rad
    eigenvalue: complex           # of the round trip, without its transmissions
    reverse_eigenvalue: complex   # of the round trip in the other direction
    loss: float                   # of power per round trip
    beyond_band: float
    modes: dict[str, Any]         # columns as those of `Wave`
    surfaces: dict[str, Any]      # columns with one entry for each inner edge and mirror: name, body, mirror, reference [m], lost, and the
                                  # complex displacement [s, 3] 1/m, rotation [s, 3] 1/rad and widening [s] 1/m, along the axes of the scene
    warnings: list[str] = field(default_factory=list)
    grid_check: dict[str, Any] | None = None      # of `wave --grid-check`: changes by a finer grid; lost as `surfaces`

    def levers(self, surface: str) -> ComplexArray:
        """Derivatives of the stray field over the main field by the motion of an inner edge or a mirror, [6]: x, y, z [1/m] and
        rotations about its `reference` [1/rad], along the axes of the scene."""
        names = self.surfaces["name"]
        if surface not in names:
            raise KeyError(f"the cavity has no inner edge or mirror '{surface}'; it has {', '.join(names)}")
        row = names.index(surface)
        return np.hstack([self.surfaces["displacement"][row], self.surfaces["rotation"][row]])


@dataclass
class SeamCheck:
    """The noise of a run and that at another crossover angle, on which it must not depend, at one frequency. Pairs: value and one
    standard error; NaN where rays are not resolved."""

    frequency: float                  # Hz
    crossover: float                  # rad, of the scene
    other_crossover: float            # rad
    histories: int                    # at the other angle
    baffles: dict[str, tuple[float, float]]    # of rays and halo: strain and other, 1/sqrt(Hz), of both angles; change, relative
    total: dict[str, tuple[float, float]]      # of all stray light


def _columns(group: Any) -> dict[str, Any]:
    """The columns of a group; parts `_real` and `_imaginary` become one complex column."""
    found: dict[str, Any] = {}
    for name, dataset in group.items():
        values = dataset[()]
        if dataset.dtype.kind in "SO":
            found[name] = [v.decode("utf-8", "replace") for v in values]
        elif name.endswith("_real"):
            found[name.removesuffix("_real")] = values + 1j * group[name.removesuffix("_real") + "_imaginary"][()]
        elif not name.endswith("_imaginary"):
            found[name] = values
    return found


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _optional(file: Any, name: str) -> dict[str, Any] | None:
    """Columns and attributes of a group of /wave that not every run has."""
    if name not in file:
        return None
    numbers = {key: value.item() for key, value in file[name].attrs.items() if key != "meaning"}
    return {**numbers, **_columns(file[name])}


def _irradiances(group: Any, mirrors: dict[str, Any], edges: dict[str, Any], length: float) -> list[Irradiance]:
    names = [mirrors["name"][0], *edges["name"], mirrors["name"][1]]
    places = [0.0, *edges["centre"][:, 2].tolist(), length]
    columns = {name: group[name][()] for name in ("plane", "towards_mirror1", "step", "rings", "sectors")}
    found, first = [], 0
    for plane, back, step, rings, sectors in zip(*columns.values()):
        part = slice(first, first := first + int(rings) * int(sectors))
        shape = (int(rings), int(sectors))
        found.append(Irradiance(names[plane], places[plane], mirrors["name"][0 if back else 1], float(step),
                                group["mean"][part].reshape(shape), group["mean_square"][part].reshape(shape)))
    return found


def wave_of(file: Any) -> Wave | None:
    """/wave; None where a run has none."""
    if "wave" not in file:
        return None
    group = file["wave"]
    number = {name: float(group.attrs[name]) for name in ("power", "wavelength", "length", "window", "crossover", "loss",
                                                          "loss_of_smooth_mirrors", "beyond_band")}
    mirrors, edges = _columns(group["mirrors"]), _columns(group["edges"])
    return Wave(
        beam=_text(group.attrs["beam"]),
        points=int(group.attrs["points"]),
        eigenvalue=complex(group.attrs["eigenvalue_real"], group.attrs["eigenvalue_imaginary"]),
        mirrors=mirrors,
        heights=_columns(group["heights"]),
        modes=_columns(group["modes"]),
        draw_offset=edges.pop("draw_offset"),
        edges=edges,
        draws=_columns(group["draws"]),
        irradiance=_irradiances(group["irradiance"], mirrors, edges, number["length"]),
        fields=[group["fields"][name][()].view(np.complex64)[..., 0] for name in ("mirror1", "mirror2")] if "fields" in group else [],
        at=group["fields/at"][()] if "fields" in group else None,
        grid_check=_optional(group, "grid_check"),
        by_frequency=_optional(group, "by_frequency"),
        photodiodes=_columns(group["photodiodes"]) if "photodiodes" in group else None,
        device=_text(group.attrs.get("device", "cpu")),
        warnings=[w.decode("utf-8", "replace") for w in group["warnings"][()]],
        **number,
    )


def wave_ring_of(file: Any) -> WaveRing | None:
    """/wave_ring; None where a run has none."""
    if "wave_ring" not in file:
        return None
    group = file["wave_ring"]
    number = {name: float(group.attrs[name]) for name in ("power", "wavelength", "length", "window", "crossover", "loss", "beyond_band")}
    return WaveRing(
        beam=_text(group.attrs["beam"]),
        points=int(group.attrs["points"]),
        eigenvalue=complex(group.attrs["eigenvalue_real"], group.attrs["eigenvalue_imaginary"]),
        reverse_eigenvalue=complex(group.attrs["reverse_eigenvalue_real"], group.attrs["reverse_eigenvalue_imaginary"]),
        modes=_columns(group["modes"]),
        surfaces=_columns(group["surfaces"]),
        warnings=[_text(w) for w in group["warnings"][()]],
        grid_check=_optional(group, "grid_check"),
        **number)


def seam_of(file: Any) -> SeamCheck | None:
    """/seam; None where a run has none."""
    if "seam" not in file:
        return None
    of = file["seam"].attrs

    def light(name: str) -> dict[str, tuple[float, float]]:
        return {key: (float(of[f"{name}_{key}"]), float(of[f"{name}_{key}_sigma"])) for key in ("strain", "other", "change")}

    return SeamCheck(float(of["frequency"]), float(of["crossover"]), float(of["other_crossover"]), int(of["histories"]),
                     light("baffles"), light("total"))
