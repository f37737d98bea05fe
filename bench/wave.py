#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fields in a cavity: legs of a long arm with two transforms, free space and a mask, compared with the same by SciPy, LightPipes, prysm and
POPPY; transforms of whole fields; modes, round trips past 98 baffles, levers of their edges; threads; legs on a GPU, where there is one.

Examples:
  scripts/bench wave --keep      512, 1024 and 2048 points per side; for the page
  scripts/bench wave --quick     once and with few points: does it run?
"""
import json
import os

from record import BUILD, SOURCE, Results, arguments, child, compared, in_turns

PEERS = SOURCE / "build/peers/bin/python"
THEIRS = """
import os, sys, time
for name in ("OMP", "MKL", "OPENBLAS", "NUMEXPR"):
    os.environ[name + "_NUM_THREADS"] = "1"
import numpy
way, points, repeats = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
window, length, wavelength = 2.0, 100.0, 1064e-9
x = (numpy.arange(points) - points // 2) * window / points
rho2 = x[:, None] ** 2 + x**2
field, mask = numpy.exp(-rho2 / 0.01).astype(complex), (rho2 < 0.42**2).astype(float)
f = numpy.fft.fftfreq(points, window / points)
factor = numpy.exp(-1j * numpy.pi * wavelength * length * (f[:, None] ** 2 + f**2))
if way == "scipy" or way == "whole":
    import scipy.fft
    if way == "whole":
        mask, factor = 1, 1
    def leg(field):
        spectrum = scipy.fft.fft2(field, overwrite_x=True)
        if way != "whole":
            spectrum *= factor
        field = scipy.fft.ifft2(spectrum, overwrite_x=True)
        if way != "whole":
            field *= mask
        return field
elif way == "LightPipes":
    import LightPipes
    field = LightPipes.Begin(window, wavelength, points)
    def leg(field):
        return LightPipes.CircAperture(LightPipes.Forvard(field, length), 0.42)
elif way == "prysm":
    from prysm.propagation import angular_spectrum
    def leg(field):
        return angular_spectrum(field, wavelength * 1e6, window / points * 1e3, length * 1e3, Q=1) * mask
else:
    import astropy.units as u, poppy
    front = poppy.FresnelWavefront(0.1 * u.m, wavelength=wavelength, npix=points // 4, oversample=4)
    hole = poppy.CircularAperture(radius=0.42)
    def leg(front):
        front.propagate_fresnel(length * u.m)
        front *= hole
        return front
    field = front
least = 1e9
for _ in range(repeats):
    start = time.process_time()
    field = leg(field)
    least = min(least, time.process_time() - start)
print(least)
"""


def theirs(way, points, repeats, core):
    python = "/usr/bin/python3" if way in ("scipy", "whole") else PEERS
    return float(child([python, "-c", THEIRS, way, points, repeats], core=core).output.split()[-1])


def ours(core, *words):
    return json.loads(child([BUILD / "bench_wave", *words], core=core).output)


def why_not(package):
    if not PEERS.exists():
        return "not installed: scripts/setup --peers"
    found = child([PEERS, "-c", f"import importlib.util as u; print(u.find_spec('{package}') is not None)"]).output
    return "" if "True" in found else "not installed: PyPI has none for this machine"


def add_legs(results, points, repeats, turns, core):
    taken = in_turns({"ours": lambda: ours(core, "legs", points, repeats), "scipy": lambda: theirs("scipy", points, repeats, core),
                      "whole": lambda: theirs("whole", points, repeats, core)}, turns)
    legs, copies = [t["leg"] for t in taken["ours"]], [t["copy"] for t in taken["ours"]]
    results.add(f"{points} × {points}, leg", unit="s", copies=1 / compared(legs, copies)["ratio"], other="scipy.fft",
                goal={"of": "copies", "at_most": 13}, **compared(legs, taken["scipy"]))
    results.add(f"{points} × {points}, whole transforms", unit="s", other="scipy.fft", goal={"of": "ratio", "at_least": 1},
                **compared([t["whole"] for t in taken["ours"]], taken["whole"]))
    return legs


def main():
    words = arguments(__doc__).parse_args()
    core = max(os.sched_getaffinity(0))
    sizes, repeats, turns = ((64,), 1, 1) if words.quick else ((512, 1024, 2048), 10, words.repeats)
    middle = sizes[len(sizes) // 2]
    with Results("wave", words) as results:
        legs = {points: add_legs(results, points, repeats, turns, core) for points in sizes}
        for peer in ("LightPipes", "prysm", "poppy"):
            case = f"{middle} × {middle}, leg of {peer}"
            if why := why_not(peer):
                results.add(case, skipped=why)
                continue
            found = [theirs(peer, middle, repeats, core) for _ in range(turns)]
            results.add(case, unit="s", other=peer, goal={"of": "ratio", "at_least": 5}, **compared(legs[middle], found))
        modes = [ours(core, "mode", sizes[0], 12)["mode"] for _ in range(turns)]
        results.add(f"{sizes[0]} × {sizes[0]}, mode of two mirrors, 12 round trips", unit="s", goal={"of": "ours", "at_most": 0.2},
                    **compared(modes))
        counts = [n for n in (1, 2, 4, 8) if n <= len(os.sched_getaffinity(0))]
        trips = in_turns({n: lambda n=n: ours(None, "arm", middle, n) for n in counts}, turns)
        results.add(f"{middle} × {middle}, round trip past 98 baffles", unit="s", goal={"of": "ours", "at_most": 1.8},
                    **compared([t["trip"] for t in trips[1]]))
        results.add(f"{middle} × {middle}, levers of 98 edges with their round trip", unit="s", goal={"of": "ours", "at_most": 2.8},
                    **compared([t["levers"] for t in trips[1]]))
        for n in sorted(set(trips) - {1}):
            results.add(f"{middle} × {middle}, round trip, {n} threads", unit="s", other="1 thread",
                        goal={"of": "ratio", "at_least": 0.8 * n}, **compared([t["wall"] for t in trips[n]], [t["wall"] for t in trips[1]]))
        found = ours(None, "device", sizes[-1], repeats)
        for key, case, goal in (("leg", "leg on a GPU", 1e-3), ("trip", "round trip past 98 baffles on a GPU", 0.25)):
            name = f"{sizes[-1]} × {sizes[-1]}, {case}"
            if "skipped" in found:
                results.add(name, skipped=found["skipped"])
            else:
                results.add(name, unit="s", device=found["device"], goal={"of": "ours", "at_most": goal}, **compared([found[key]]))


if __name__ == "__main__":
    main()
