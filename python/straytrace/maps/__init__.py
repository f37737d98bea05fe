# SPDX-License-Identifier: BSD-3-Clause
"""Power spectrum of a mirror map, as read by the BSDF model `psd`, or its heights, as read by the table `wave`.

python3 -m straytrace.maps ETM.dat -o etm_psd.csv --aperture "30 cm" --remove curvature
python3 -m straytrace.maps ETM_asc.dat -o etm_psd.csv --aperture "16 cm" --remove tilt --join wide.json --plot etm.png
python3 -m straytrace.maps ETM.dat -o etm.h5
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import pathlib
import sys

import h5py
import numpy as np

from .files import MapError, MirrorMap, read_map

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
REMOVED = ("piston", "tilt", "curvature", "astigmatism")   # each with those before it
BINS_PER_DECADE = 20


@dataclasses.dataclass
class Spectrum:
    """2D PSD of the heights, two-sided, mean over azimuth (docs/theory/surfaces.md, eq. 3.6)."""

    f: np.ndarray                      # 1/m
    s2: np.ndarray                     # m^4
    error: np.ndarray                  # one standard error of s2, from the scatter within each ring
    rms: float                         # of the heights under the window, m; all frequencies of the map
    rms_band: float                    # sqrt of the PSD integrated over the rings, m
    edges: tuple[float, float]         # where the first ring begins and the last ends, 1/m


def length(text: str) -> float:
    """'30 cm' in m."""
    words = text.split()
    if len(words) != 2 or words[1] not in UNITS:
        raise argparse.ArgumentTypeError(f"'{text}' is not a length; write for example '30 cm' ({', '.join(UNITS)})")
    try:
        value = float(words[0]) * UNITS[words[1]]
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise argparse.ArgumentTypeError(f"'{words[0]}' is not a finite number; write for example '30 cm'")
    return value


def grid(shape, pixel, centre):
    """Coordinates of the pixels in m from `centre` (m, from the middle of the map): x to the right, y upwards."""
    y = ((shape[0] - 1) / 2 - np.arange(shape[0])) * pixel - centre[1]
    x = (np.arange(shape[1]) - (shape[1] - 1) / 2) * pixel - centre[0]
    return np.meshgrid(x, y)


def without_figure(height, x, y, inside, removed):
    """Heights less the fitted figure. Returns them and the radius of curvature taken out, in m (infinite: none)."""
    terms = [np.ones_like(x)]
    if removed in REMOVED[1:]:
        terms += [x, y]
    if removed in REMOVED[2:]:
        terms += [x**2 + y**2]
    if removed in REMOVED[3:]:
        terms += [x**2 - y**2, x * y]
    scale = [np.sqrt(np.mean(t[inside]**2)) for t in terms]
    matrix = np.stack([t[inside] / s for t, s in zip(terms, scale)], axis=1)
    fit, *_ = np.linalg.lstsq(matrix, height[inside], rcond=None)
    figure = sum(c * t / s for c, t, s in zip(fit, terms, scale))
    curvature = 2 * fit[3] / scale[3] if len(terms) > 3 else 0.0
    return height - figure, np.inf if curvature == 0 else 1 / curvature


def spectrum_of(height, pixel, window) -> Spectrum:
    """S2 = |sum h w exp(-2 pi i f r)|^2 pixel^2 / sum w^2: the window takes no power, so that the integral of S2 over
    the plane of frequencies is the variance under it. Rings even in log f, from 3/extent to the Nyquist frequency."""
    w2 = np.sum(window**2)
    values = np.where(window > 0, np.nan_to_num(height), 0)
    values = (values - np.sum(values * window**2) / w2) * window
    power = np.abs(np.fft.fft2(values))**2 * pixel**2 / w2
    fy, fx = (np.fft.fftfreq(n, pixel) for n in height.shape)
    radius = np.hypot(*np.meshgrid(fx, fy))
    nyquist, step = 0.5 / pixel, 1 / (pixel * np.sqrt(window.shape[0] * window.shape[1]))
    low = 3 / (pixel * np.sqrt(np.count_nonzero(window) * 4 / np.pi))
    edges = [low]
    while edges[-1] < nyquist:          # no ring narrower than two steps of frequency
        edges.append(min(max(edges[-1] * 10**(1 / BINS_PER_DECADE), edges[-1] + 2 * step), nyquist))
    f, s2, error, variance, ends = [], [], [], 0.0, []
    correlated = window.size * np.sum(window**4) / w2**2     # neighbouring frequencies that the window joins
    for a, b in zip(edges, edges[1:]):
        ring = (radius >= a) & (radius < b)
        count = np.count_nonzero(ring)
        if count < 8:
            continue
        f.append(np.exp(np.mean(np.log(radius[ring]))))
        s2.append(np.mean(power[ring]))
        error.append(np.std(power[ring]) / np.sqrt(max(count / 2 / correlated, 1)))    # f and -f are one number
        variance += s2[-1] * np.pi * (b**2 - a**2)
        ends += [a, b]
    rms = np.sqrt(np.sum(values**2) / w2)
    return Spectrum(np.array(f), np.array(s2), np.array(error), float(rms), float(np.sqrt(variance)),
                    (ends[0], ends[-1]))


def power_law_variance(f, s2) -> float:
    """2 pi times the integral of S2 f df (eq. 3.6), a power law between the points, as the law psd takes it."""
    fine = np.geomspace(f[0], f[-1], 20000)
    values = 2 * np.pi * fine**2 * np.exp(np.interp(np.log(fine), np.log(f), np.log(s2)))
    return float(np.sum((values[1:] + values[:-1]) / 2) * np.log(fine[1] / fine[0]))


def table_of(spectrum: Spectrum):
    """The spectrum from edge to edge of its rings. Power laws between rings that scatter by chance hold a little less
    than the rings; all values are raised so that the variance is theirs. Third: that factor."""
    f, s2 = spectrum.f, spectrum.s2
    low = s2[0] * (spectrum.edges[0] / f[0])**(np.log(s2[1] / s2[0]) / np.log(f[1] / f[0]))
    high = s2[-1] * (spectrum.edges[1] / f[-1])**(np.log(s2[-1] / s2[-2]) / np.log(f[-1] / f[-2]))
    f, s2 = np.r_[spectrum.edges[0], f, spectrum.edges[1]], np.r_[low, s2, high]
    factor = spectrum.rms_band**2 / power_law_variance(f, s2)
    return f, s2 * factor, factor


def analyse(surface: MirrorMap, pixel, aperture, removed, centre=(0.0, 0.0)):
    """Spectrum of the map within a disc of diameter `aperture` (m), under a radial Hann window. With it the residual
    heights, the radius of curvature removed, and the share of the disc without data."""
    x, y = grid(surface.height.shape, pixel, centre)
    radius = np.hypot(x, y)
    disc = radius < aperture / 2
    inside = disc & np.isfinite(surface.height)
    missing = 1 - np.count_nonzero(inside) / max(np.count_nonzero(disc), 1)
    extent = pixel * min(surface.height.shape)
    if aperture > extent + pixel or np.count_nonzero(disc) < 1000:
        raise MapError(f"a disc of {aperture * 100:g} cm has {np.count_nonzero(disc)} pixels of a map of "
                       f"{extent * 100:.4g} cm; give --aperture the diameter that was measured, and check --pixel")
    if missing > 0.1:
        raise MapError(f"{100 * missing:.0f} % of the disc of {aperture * 100:g} cm has no data; give a smaller --aperture "
                       f"or another --centre")
    residual, roc = without_figure(surface.height, x, y, inside, removed)
    window = np.where(inside, np.cos(np.pi * radius / aperture)**2, 0)
    return spectrum_of(residual, pixel, window), np.where(inside, residual, np.nan), roc, missing


def wide_angle(path, wavelength):
    """S2 from measured scatter, the JSON of `straytrace inspect FILE --format json`: eq. 3.8 with Q = 1, medians over
    twentieths of a decade. Frequencies in 1/m, S2 in m^4."""
    data = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    measured = data["wavelength"]
    if abs(measured / wavelength - 1) > 1e-3:
        raise MapError(f"{path}: measured at {measured * 1e9:g} nm, not {wavelength * 1e9:g} nm; give --wavelength")
    rows = [(p["offset"] / measured, p["bsdf"] * measured**4 / (16 * np.pi**2 * p["cos_i"] * p["cos_s"]))
            for p in data["points"] if not p["limit"] and p["cos_s"] and p["offset"] > 0]
    if len(rows) < 2:
        raise MapError(f"{path}: fewer than two points above the noise floor")
    f, s2 = np.array(sorted(rows)).T
    place = np.floor(np.log10(f) * BINS_PER_DECADE)
    return tuple(np.array([np.exp(np.median(np.log(v[place == p]))) for p in np.unique(place)]) for v in (f, s2))


def joined(map_f, map_s2, f, s2):
    """The map up to its last frequency, then the wide-angle data beyond. Third: median of wide/map where both are, or
    None."""
    overlap = (f >= map_f[0]) & (f <= map_f[-1])
    factor = None
    if overlap.any():
        there = np.exp(np.interp(np.log(f[overlap]), np.log(map_f), np.log(map_s2)))
        factor = float(np.exp(np.median(np.log(s2[overlap] / there))))
    beyond = f > map_f[-1]
    return np.r_[map_f, f[beyond]], np.r_[map_s2, s2[beyond]], factor


def report(surface, pixel, options, spectrum, roc, missing, raised, factor) -> list[str]:
    tis = (4 * np.pi * spectrum.rms_band / options.wavelength)**2
    lines = [f"{options.map.name}: {surface.kind}, {surface.height.shape[1]} x {surface.height.shape[0]} pixels of "
             f"{pixel * 1e3:.5g} mm, {surface.scale}",
             f"disc of {options.aperture * 100:.6g} cm, {100 * missing:.2g} % without data; removed: up to {options.remove}"
             + (f", radius of curvature {roc:.6g} m" if np.isfinite(roc) else ""),
             f"radial Hann window, its power normalised; 2d PSD, two-sided, mean over azimuth; times {raised:.4g}, so that "
             "power laws between the rings hold their variance",
             f"rms {spectrum.rms * 1e9:.4g} nm under the window, {spectrum.rms_band * 1e9:.4g} nm between "
             f"{spectrum.edges[0]:.4g} and {spectrum.edges[1]:.4g} 1/m (eq. 3.6)",
             f"TIS of that band at {options.wavelength * 1e9:g} nm: {tis:.4g} (eq. 3.10, normal incidence, R = 1)"]
    if options.join:
        lines.append(f"joined to {options.join.name}: " + (
            f"wide-angle data are {factor:.3g} times the map where both are given; nothing is rescaled" if factor else
            "no overlap with the map; the gap is bridged by a power law"))
    return lines


def draw(path, residual, aperture, spectrum, f, s2, title):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from ..plots.style import STYLE, save
    with plt.rc_context(STYLE | {"font.size": 9.5}):
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.2), dpi=100)
        half = residual.shape[0] * aperture["pixel"] * 50, residual.shape[1] * aperture["pixel"] * 50
        limit = 1e9 * np.nanpercentile(np.abs(residual), 99)
        image = left.imshow(1e9 * residual, cmap="RdBu_r", vmin=-limit, vmax=limit,
                            extent=(-half[1], half[1], -half[0], half[0]))
        left.set(xlabel="x [cm]", ylabel="y [cm]", title="residual height [nm]")
        left.grid(False)
        figure.colorbar(image, ax=left, shrink=0.85)
        right.loglog(f, s2, color="#D55E00", linewidth=1.2, label="written")
        right.errorbar(spectrum.f, spectrum.s2, yerr=spectrum.error, fmt="o", markersize=3, color="#0072B2", label="map")
        right.set(xlabel="spatial frequency [1/m]", ylabel="2d PSD [m$^4$]", title=title)
        right.legend()
        figure.tight_layout()
        save(figure, path)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="straytrace.maps", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", type=pathlib.Path,
                        help="MetroPro .dat, Zygo .asc or .xyz, LIGO _asc.dat, FINESSE map, matrix of heights in m (OSCAR)")
    parser.add_argument("-o", "--out", type=pathlib.Path, required=True,
                        help="PSD file for the law psd, or heights for the table wave: FILE.h5")
    parser.add_argument("--aperture", type=length,
                        help="diameter of the disc that counts: '30 cm'. Without it FILE.h5 holds the whole map")
    parser.add_argument("--remove", choices=REMOVED,
                        help="figure to remove, each with those before it: errors that do not scatter the beam")
    parser.add_argument("--pixel", type=length, help="of maps that do not state it: '0.4 mm'")
    parser.add_argument("--centre", type=length, nargs=2, metavar=("X", "Y"),
                        help="of the disc, from the middle of the map: '1 mm' '-2 mm' (as the file states, else '0 mm' '0 mm')")
    parser.add_argument("--wavelength", type=length, default=1.064e-6, help="of the scattered light (1064 nm)")
    parser.add_argument("--join", type=pathlib.Path, help="wide-angle scatter: JSON of straytrace inspect")
    parser.add_argument("--plot", type=pathlib.Path, help="picture of map and spectrum")
    options = parser.parse_args(arguments)
    given = [f"--{name}" for name in ("remove", "join", "plot") if getattr(options, name)]
    missing = [f"--{name}" for name in ("aperture", "remove") if getattr(options, name) is None]
    if writes_heights(options.out) and given:
        parser.error(f"{given[0]} is for spectra; remove it: the scene states what the cavity does not keep")
    if not writes_heights(options.out) and missing:
        parser.error(f"a spectrum needs {' and '.join(missing)}")
    return options


def writes_heights(out) -> bool:
    return out.suffix in (".h5", ".hdf5")


def write_heights(options, surface, pixel, centre):
    """Heights in m with x and y from the centre, rows from the lowest y."""
    x, y = (values[::-1] for values in grid(surface.height.shape, pixel, centre))
    height = surface.height[::-1].copy()
    if options.aperture:
        height[np.hypot(x, y) > options.aperture / 2] = np.nan
    measured = np.count_nonzero(np.isfinite(height))
    if measured == 0:
        raise MapError(f"{options.map}: the disc holds no pixel with data; check --aperture and --centre")
    temporary = options.out.with_name(options.out.name + ".part")
    with h5py.File(temporary, "w") as file:
        for name, values in (("x", x[0]), ("y", y[:, 0]), ("height", height)):
            file.create_dataset(name, data=values).attrs["unit"] = "m"
    temporary.replace(options.out)
    print(f"{options.map.name}: {surface.kind}, {height.shape[1]} x {height.shape[0]} pixels of {pixel * 1e3:.5g} mm, "
          f"{measured} with data, {surface.scale}")
    print(f"written: {options.out}\n  wave: {{maps: {{MIRROR: {{file: {options.out.name}}}}}}}")


def pixel_of(options, surface) -> float:
    """Side of a pixel in m, from the file or the command line."""
    given, stated = options.pixel, surface.pixel if 0 < surface.pixel < 1 else None
    if given is not None and not 0 < given < 1:
        raise MapError(f"--pixel is {given:g} m; give a length between 0 and 1 m: --pixel '0.4 mm'")
    if None not in (given, stated) and abs(given / stated - 1) > 1e-3:
        raise MapError(f"{options.map}: the file states pixels of {stated * 1e3:.6g} mm, --pixel is {given * 1e3:.6g} mm; "
                       f"leave out --pixel, or correct the file")
    if given is None and stated is None:
        raise MapError(f"{options.map}: the file does not state its pixel size; give it: --pixel '0.4 mm'")
    return stated or given


def centre_of(options, surface, pixel):
    """Of the disc, in m from the middle of the map."""
    centre = options.centre or surface.centre
    half = [n * pixel / 2 for n in surface.height.shape[::-1]]
    if any(abs(c) > h for c, h in zip(centre, half)):
        source = "--centre" if options.centre else f"{options.map}: the centre that the file states"
        raise MapError(f"{source} is {centre[0] * 1e3:.6g} mm, {centre[1] * 1e3:.6g} mm from the middle of a map of "
                       f"{2e3 * half[0]:.6g} x {2e3 * half[1]:.6g} mm; give a --centre within it")
    return centre


def run(options):
    surface = read_map(options.map)
    pixel = pixel_of(options, surface)
    centre = centre_of(options, surface, pixel)
    if writes_heights(options.out):
        return write_heights(options, surface, pixel, centre)
    spectrum, residual, roc, missing = analyse(surface, pixel, options.aperture, options.remove, centre)
    f, s2, raised = table_of(spectrum)
    factor = None
    if options.join:
        f, s2, factor = joined(f, s2, *wide_angle(options.join, options.wavelength))
    lines = report(surface, pixel, options, spectrum, roc, missing, raised, factor)
    text = "".join(f"# {line}\n" for line in lines) + "f [1/m], s2 [m^4]\n"
    text += "".join(f"{a:.7g}, {b:.7g}\n" for a, b in zip(f, s2))
    if options.plot:
        draw(options.plot, residual, {"pixel": pixel}, spectrum, f, s2, options.map.name)
    temporary = options.out.with_name(options.out.name + ".part")
    temporary.write_text(text, encoding="utf-8")
    temporary.replace(options.out)
    print("\n".join(lines))
    print(f"written: {options.out}\n  scatter: {{model: psd, file: {options.out.name}, dimension: 2d, sides: two, "
          f"beyond: {'power' if options.join else 'zero'}, source: \"{options.map.name}\"}}")


def main(arguments=None) -> int:
    options = parse(arguments)
    try:
        run(options)
    except OSError as error:
        print(f"error: '{error.filename}': {error.strerror}; check the name and the folder", file=sys.stderr)
    except KeyError as error:
        print(f"error: {options.join}: no {error}; give what 'straytrace inspect FILE --format json' prints", file=sys.stderr)
    except ValueError as error:
        print(f"error: {error}", file=sys.stderr)
    else:
        return 0
    return 2
