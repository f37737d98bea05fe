"""Mirror maps: the formats give heights in m, and the spectrum is that of the surface. Usage: test_maps.py STRAYTRACE"""
import contextlib
import io
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

import h5py
import numpy as np

from records import Records

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "python"))

from straytrace import maps  # noqa: E402
from straytrace.maps.files import INVALID, MapError, MirrorMap, read_map  # noqa: E402

WAVELENGTH = 633e-9
LAMBDA = 1064e-9
RECORDS = Records("tools.maps", sys.argv[1])
RNG = np.random.default_rng(1)


def knee(f):
    """2D PSD of eq. 3.13 in m^4: rms 1 nm over all frequencies, knee at 1/(2 cm), C = 1.6."""
    b, c, rms = 0.02, 1.6, 1e-9
    return rms**2 * (c - 1) * b**2 / (2 * np.pi) / (1 + (b * f)**2)**((c + 1) / 2)


def made(n, pixel, psd=knee):
    """A surface with that two-sided PSD: heights of the cosine sum of all frequencies of the grid."""
    f = np.hypot(*np.meshgrid(np.fft.fftfreq(n, pixel), np.fft.fftfreq(n, pixel)))
    white = np.fft.fft2(RNG.standard_normal((n, n)))       # |white|^2 has the mean n^2
    amplitude = np.sqrt(np.where(f > 0, psd(np.maximum(f, 1e-3)), 0)) / pixel
    return np.fft.ifft2(white * amplitude).real


def metropro(counts, scale=0.5, resolution=1, pixel=4e-4, version=2):
    header = bytearray({1: 834, 2: 834, 3: 4096}[version])
    struct.pack_into(">IhI", header, 0, 0x881B036E + version, version, len(header))
    rows, columns = counts.shape
    struct.pack_into(">hhhhi", header, 64, 0, 0, columns, rows, 4 * counts.size)
    struct.pack_into(">fffff", header, 164, scale, WAVELENGTH, 0, 1.0, 1)
    struct.pack_into(">f", header, 184, pixel)
    struct.pack_into(">h", header, 218, resolution)
    return bytes(header) + counts.astype(">i4").tobytes()


def zygo(counts, blocks=2, end="\n"):
    """Zygo ASCII with an empty block of intensities, or LIGO's, which has none."""
    rows, columns = counts.shape
    lines = ["Zygo ASCII Data File - Format 2", "0 0 0 0 \"\"", "0 0 0 0 0 0", f"0 0 {columns} {rows}", '""', '""', '""',
             f"0 0.5 {WAVELENGTH} 0 1 0 4e-4 0", "0 0 0 0 0 0 \"\"", "0 0 0 0 0 0 0 0 0 0", "1 1 20 2 0 0 0 0 0",
             '0 ""', "1 0", '""'] + ["#"] * blocks
    lines += [" ".join(str(int(c)) for c in row) for row in counts]
    return end.join(lines + ["#"]) + end


def zygo_xyz(height):
    lines = zygo(np.zeros_like(height)).splitlines()[:14]
    lines[0] = "Zygo XYZ Data File - Format 1"
    for row, values in enumerate(height):
        lines += [f"{column} {row} {'No Data' if np.isnan(v) else repr(v * 1e6)}" for column, v in enumerate(values)]
    return "\n".join(lines + ["#"]) + "\n"


def rejected(path, reason):
    try:
        read_map(path)
    except MapError as error:
        assert reason in str(error), error
        return
    raise AssertionError(f"{path} was accepted; {reason}")


def check_formats(folder):
    """Half a wavelength of height is one fringe in reflection: scale factor 0.5 and 32768 counts."""
    counts = np.array([[0, 32768, -32768], [16384, INVALID, 7]])
    expected = np.array([[0, 0.5, -0.5], [0.25, np.nan, 0.5 * 7 / 32768]]) * WAVELENGTH
    for version in (1, 2, 3):
        (folder / "a.dat").write_bytes(metropro(counts, version=version))
        got = read_map(folder / "a.dat")
        np.testing.assert_allclose(got.height, expected, rtol=1e-6)     # float32 in the header
        assert abs(got.pixel - 4e-4) < 1e-9 and got.kind == "MetroPro"
    for wrong in (dict(scale=1.0), dict(resolution=0)):                 # controls: a factor 2, and 8
        (folder / "a.dat").write_bytes(metropro(counts, **wrong))
        assert abs(read_map(folder / "a.dat").height[0, 1] / expected[0, 1] - 1) > 0.5
    for text in (zygo(counts), zygo(counts, blocks=1), zygo(counts, end="\r\n")):
        (folder / "a_asc.dat").write_text(text, newline="")
        np.testing.assert_allclose(read_map(folder / "a_asc.dat").height, expected, rtol=1e-9)
    (folder / "a.xyz").write_text(zygo_xyz(expected))
    np.testing.assert_allclose(read_map(folder / "a.xyz").height, expected, rtol=1e-9)
    assert not np.allclose(read_map(folder / "a.xyz").height, expected[:, ::-1], equal_nan=True)


def finesse(height, pixel, centre, kind="phase reflection", scaling=1e-9):
    """As pykat writes it: rows from the lowest y."""
    rows, columns = height.shape
    lines = ["% Surface map", "% Name: m", f"% Type: {kind}", f"% Size: {rows} {columns}",
             f"% Optical center (x,y): {centre[0]} {centre[1]}", f"% Step size (x,y): {pixel} {pixel}", f"% Scaling: {scaling}",
             "", ""]
    return "\n".join(lines + [" ".join("%.15g" % (v / scaling) for v in row) + " " for row in height]) + "\n"


def check_heights(folder):
    """FINESSE maps and matrices of OSCAR have the lowest y first; FILE.h5 has heights by rows from the lowest y, with x and
    y from the centre. Controls: rows upside down, the middle of the map instead of its centre."""
    height = 1e-9 * (np.arange(10)[None, :] + 100.0 * np.arange(12)[:, None])    # y upwards
    height[0, 3] = np.nan
    (folder / "a.map").write_text(finesse(height, 5e-4, (5.5 + 2, 6.5 - 1)))
    (folder / "a.txt").write_text("\n".join(" ".join(map(str, row)) for row in height))
    for name, options, centre in (("a.map", [], (1e-3, -5e-4)), ("a.map", ["--centre", "0 mm", "0 mm"], (0, 0)),
                                  ("a.txt", ["--pixel", "0.5 mm"], (0, 0)),
                                  ("a.txt", ["--pixel", "0.5 mm", "--centre", "1 mm", "-0.5 mm"], (1e-3, -5e-4))):
        assert maps.main([str(folder / name), "-o", str(folder / "a.h5"), *options]) == 0
        with h5py.File(folder / "a.h5") as file:
            np.testing.assert_allclose(file["height"][:], height, rtol=1e-12)
            assert not np.allclose(file["height"][:][::-1], height, equal_nan=True)
            np.testing.assert_allclose(file["x"][:], (np.arange(10) - 4.5) * 5e-4 - centre[0], atol=1e-15)
            np.testing.assert_allclose(file["y"][:], (np.arange(12) - 5.5) * 5e-4 - centre[1], atol=1e-15)
            assert file["height"].attrs["unit"] == "m"
    assert not list(folder.glob("*.part"))
    disc = ["--pixel", "0.5 mm", "--aperture", "4 mm"]
    assert maps.main([str(folder / "a.txt"), "-o", str(folder / "a.h5"), *disc]) == 0
    with h5py.File(folder / "a.h5") as file:
        x, y = np.meshgrid(file["x"], file["y"])
        assert np.array_equal(np.isfinite(file["height"]), np.hypot(x, y) <= 2e-3)
    counts = np.array([[0, 32768], [16384, 7]])             # the first row of MetroPro is at the top
    (folder / "a.dat").write_bytes(metropro(counts))
    assert maps.main([str(folder / "a.dat"), "-o", str(folder / "a.h5")]) == 0
    with h5py.File(folder / "a.h5") as file:
        np.testing.assert_allclose(file["height"][:] / WAVELENGTH, [[0.25, 0.5 * 7 / 32768], [0, 0.5]], rtol=1e-6)


def check_refused_heights(folder):
    height = np.zeros((9, 8))
    path = folder / "bad"
    for content, reason in ((finesse(height, 5e-4, (4, 4), "absorption both"), ":3:1: a map of type 'absorption both'"),
                            (finesse(height, 5e-4, (4, 4)).replace("% Scaling", "% Other"), "no line '% Scaling: '"),
                            (finesse(height, 5e-4, (4, 4)).replace("Step size (x,y): 0.0005", "Step size (x,y): 0.001"),
                             "square pixels"),
                            (finesse(height, 5e-4, (4, 4)) + "1 2\n", ":19:1: 2 numbers, the rows before have 8"),
                            ("1 2 3\n4 5 six\n", ":2:1: could not convert"), ("1 2\n3 4\n", "2 x 2 numbers is no map"),
                            ("% Surface map\n", "no line '% Optical")):
        path.write_text(content)
        rejected(path, reason)
    path.write_text("0 " * 8 + "\n" + ("0 " * 8 + "\n") * 8)
    assert maps.main([str(path), "-o", str(folder / "no.h5")]) == 2    # without --pixel
    for arguments in (["-o", str(folder / "no.h5"), "--remove", "tilt"], ["-o", str(folder / "no.csv"), "--remove", "tilt"]):
        try:
            maps.main([str(path), *arguments])
        except SystemExit as error:
            assert error.code == 2
        else:
            raise AssertionError(f"{arguments} were accepted")
    assert not (folder / "no.h5").exists()


def check_refused_options(folder):
    """Options that are no lengths, or contradict the map; each with the same option as it is accepted."""
    (folder / "a.map").write_text(finesse(np.zeros((12, 10)), 5e-4, (5.5, 6.5)))

    def said(*options):
        text = io.StringIO()
        with contextlib.redirect_stderr(text), contextlib.redirect_stdout(io.StringIO()):
            try:
                code = maps.main([str(folder / "a.map"), "-o", str(folder / "o.h5"), *options])
            except SystemExit as error:
                code = error.code
        assert code == (2 if text.getvalue() else 0) and (folder / "o.h5").exists() == (code == 0), text.getvalue()
        (folder / "o.h5").unlink(missing_ok=True)
        return text.getvalue()
    assert "'nan' is not a finite number" in said("--centre", "nan mm", "0 mm")
    assert "'inf' is not a finite number" in said("--pixel", "inf mm")
    outside = said("--centre", "3 mm", "0 mm")
    assert "--centre is 3 mm, 0 mm from the middle of a map of 5 x 6 mm; give a --centre within it" in outside
    assert said("--centre", "2 mm", "2.9 mm") == ""
    contradicting = said("--pixel", "0.4 mm")
    assert "the file states pixels of 0.5 mm, --pixel is 0.4 mm; leave out --pixel" in contradicting
    assert said("--pixel", "0.5 mm") == ""
    assert "--pixel is -0.0005 m; give a length between" in said("--pixel", "-0.5 mm")
    (folder / "a.map").write_text(finesse(np.zeros((12, 10)), 5e-4, (50, 6.5)))
    assert "the centre that the file states is 22.25 mm" in said()


def check_refusals(folder):
    counts = np.zeros((4, 4))
    path = folder / "bad"
    for content, reason in ((metropro(counts)[:-8], "14 of 16 pixels"), (metropro(counts, scale=float("nan")), "scale factor"),
                            (metropro(counts, resolution=9), "phase resolution 9"),
                            (metropro(np.full((4, 4), INVALID)), "no pixel has data"),
                            (zygo(counts).replace("0 0 4 4", "0 0 4 5").encode(), "4 x 5 = 20 phases"),
                            (zygo(counts).replace("0 0.5", "0 0,5").encode(), ":8:1:"),
                            (b"hello", "no known map"), (zygo(counts)[:60].encode(), "ends within its header")):
        path.write_bytes(content)
        rejected(path, reason)
    assert maps.main([str(path), "-o", str(folder / "no.csv"), "--aperture", "1 cm", "--remove", "tilt"]) == 2
    assert not (folder / "no.csv").exists()


def check_spectrum():
    """The spectrum is that of the surface within 5 standard errors, ring by ring, and its integral (eq. 3.6) the
    variance. Control: a window whose power is not normalised. Tilt and curvature are removed, and the curvature is printed."""
    n, pixel = 512, 5e-4
    height = made(n, pixel)
    x, y = maps.grid(height.shape, pixel, (0, 0))
    bent = height + 3e-6 * x + 1e-6 * y + (x**2 + y**2) / (2 * 1500.0)
    spectrum, _, roc, missing = maps.analyse(MirrorMap(bent, pixel, "", 0, ""), pixel, 0.25, "curvature")
    assert missing == 0 and RECORDS.near("radius of curvature in m", roc, 1500, 0.15), roc
    pull = (spectrum.s2 - knee(spectrum.f)) / spectrum.error
    high = spectrum.f > 30                                  # the lowest rings lose what the fitted figure takes
    assert RECORDS.below("largest deviation of the PSD in standard errors", np.max(np.abs(pull[high])), 5), pull
    assert RECORDS.below("spread of these", np.std(pull[high]), 2), pull
    assert np.all((spectrum.error < 0.2 * spectrum.s2)[spectrum.f > 150])
    wrong = spectrum.s2 * np.sum(np.hypot(x, y) < 0.125) / n**2 * 3 / 8    # negative control
    assert np.any(np.abs((wrong - knee(spectrum.f)) / spectrum.error)[high] > 5)
    left = maps.analyse(MirrorMap(bent, pixel, "", 0, ""), pixel, 0.25, "tilt")[0]
    assert left.s2[0] > 100 * spectrum.s2[0]                # control: remaining curvature is not roughness
    return height, pixel


def check_tis(folder, program):
    """Eq. 3.10: the law psd scatters (4 pi sigma/lambda)^2 with the rms of the map, to 1 %. The roughness lies about one
    frequency, so that the rings hold all of it."""
    n, pixel = 512, 5e-4
    height = made(n, pixel, lambda f: 1e-27 * (f / 150)**2 / (1 + (f / 150)**2)**4)
    counts = np.round(height / (0.5 * WAVELENGTH / 131072))
    (folder / "m.dat").write_bytes(metropro(counts, resolution=2, pixel=pixel))
    command = [str(folder / "m.dat"), "-o", str(folder / "psd.csv"), "--aperture", "25 cm", "--remove", "piston"]
    assert maps.main(command) == 0
    x, y = maps.grid(height.shape, pixel, (0, 0))
    window = np.where(np.hypot(x, y) < 0.125, np.cos(np.pi * np.hypot(x, y) / 0.25)**2, 0)
    sigma = np.sqrt(np.sum((counts * 0.5 * WAVELENGTH / 131072 * window)**2) / np.sum(window**2))
    (folder / "s.yaml").write_text(
        "straytrace: 1\nmaterials:\n  m: {scatter: {model: psd, file: psd.csv, dimension: 2d, sides: two, beyond: zero}}\n")
    run = subprocess.run([program, "inspect", "m", str(folder / "s.yaml"), "--format", "json"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    tis = json.loads(run.stdout)["tis"][0]["scattered"]
    expected = (4 * np.pi * sigma / LAMBDA)**2
    assert RECORDS.near("TIS", tis, expected, 0.01 * expected), (tis, expected)
    assert abs(tis / (4 * expected) - 1) > 0.5              # control: heights of a wavefront, twice those of the surface


def check_join(folder, program, height, pixel):
    """Wide-angle scatter of the same surface, eq. 3.8, meets the map with a factor of 1; four times as much, with 4."""
    surface = MirrorMap(height, pixel, "", 0, "")
    spectrum = maps.analyse(surface, pixel, 0.25, "piston")[0]
    offset = np.geomspace(3e-4, 0.3, 60)
    cosine = np.sqrt(1 - offset**2)
    for factor in (1, 4):
        bsdf = factor * 16 * np.pi**2 / LAMBDA**4 * cosine * knee(offset / LAMBDA)
        rows = "".join(f"{a:.8f}, {b:.6g}\n" for a, b in zip(np.degrees(np.arcsin(offset)), bsdf))
        (folder / "wide.csv").write_text("# wavelength: 1064 nm\n# angles: from_normal\n# theta_i: 0 deg\n"
                                         "theta_s [deg], brdf [1/sr]\n" + rows)
        run = subprocess.run([program, "inspect", str(folder / "wide.csv"), "--format", "json"], capture_output=True, text=True)
        assert run.returncode == 0, run.stderr
        (folder / "wide.json").write_text(run.stdout)
        f, s2, met = maps.joined(*maps.table_of(spectrum)[:2], *maps.wide_angle(folder / "wide.json", LAMBDA))
        assert RECORDS.near("factor where map and wide angles meet", met, factor, 0.2 * factor), (met, factor)
        assert np.all(np.diff(f) > 0) and f[-1] > 1e5
        np.testing.assert_allclose(s2[f > 5e3] / factor, knee(f[f > 5e3]), rtol=0.02)


with tempfile.TemporaryDirectory() as name:
    here = pathlib.Path(name)
    check_formats(here)
    check_refusals(here)
    check_heights(here)
    check_refused_heights(here)
    check_refused_options(here)
    made_height, made_pixel = check_spectrum()
    check_tis(here, sys.argv[1])
    check_join(here, sys.argv[1], made_height, made_pixel)
RECORDS.write()
print("ok")
