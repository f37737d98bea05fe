"""Specular layouts become scenes that straytrace follows. Usage: test_layouts.py STRAYTRACE"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "python"))

from straytrace import layouts  # noqa: E402
from straytrace.layouts.scene import LayoutError, rotation, scene_text  # noqa: E402

# A waist at the launch; a mirror at 45 deg sends the beam along +y to a dump; a lens of 0.5 m is in front of it.
TIA = """# a bench
Fold
order = 1
bm 1*mm, 1*mm, Wl = 1064*nm, P = 2*W, Ref = 'IN'
bo 1*m, 0, 0
mr Phi = 135*deg, Wedge = {wedge}*deg, HRK = 0, Diameter = 10*cm, Thickness = 2*cm, N = 1.45, HRr = {r}, HRt = 0.01, Ref = 'M1'
th 0, 40*cm, 0, 90*deg, -90*deg, Focal = 50*cm, Diameter = 5*cm, R = 0, T = 1, Ref = 'L1'
bd 0, 1*m, 0, 90*deg, -90*deg, 4*cm, 1*cm, 'END'
gh 0, 90*cm, 0, 90*deg, -90*deg, 4*cm, 'MID'
"""

GTRACE = {"name": "KAGRA-like", "optics": [
    {"type": "Mirror", "name": "M1", "HRcenter": [1.0, 0.0], "normAngleHR": 3 * math.pi / 4, "diameter": 0.1,
     "thickness": 0.02, "wedgeAngle": 0.01, "inv_ROC_HR": 0.0, "inv_ROC_AR": 0.0, "Refl_HR": 0.99, "Trans_HR": 0.01,
     "Refl_AR": 0.001, "Trans_AR": 0.999, "n": 1.45},
    {"type": "Mirror", "name": "M2", "HRcenter": [1.0, 2.0], "normAngleHR": -math.pi / 2, "diameter": 0.1,
     "thickness": 0.02, "wedgeAngle": 0.0, "inv_ROC_HR": 0.1, "inv_ROC_AR": 0.0, "Refl_HR": 0.5, "Trans_HR": 0.5,
     "Refl_AR": 0.001, "Trans_AR": 0.999, "n": 1.45}],
    "sources": [{"name": "in", "pos": [0.0, 0.0], "dirAngle": 0.0, "wl": 1.064e-6, "P": 1.0, "qx": [-0.5, 2.0],
                 "qy": [-0.5, 2.0]}]}


ZEMAX = """VERS 181025 0 123457 L123457
MODE SEQ
NAME a doublet and a window
UNIT MM X W X CM MR CPMM
ENPD 1.0E+1
WAVM 1 0.5876 1
WAVM 2 1.064 1
PWAV 2
SURF 0
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ INFINITY
  DIAM 0 0 0 0 1 ""
SURF 1
  TYPE STANDARD
  CURV 0.0159235668789809 0 0 0 0 ""
  DISZ 4.0
  GLAS N-BK7 0 0 1.5168 64.17 0 0 0 0 0 0
  DIAM 12.7 1 0 0 1 ""
SURF 2
  TYPE STANDARD
  CURV -0.0218818380743982 0 0 0 0 ""
  GLAS SF5 0 0 1.6727 32.21 0 0 0 0 0 0
  DISZ 2.5
  DIAM 12.7 1 0 0 1 ""
SURF 3
  TYPE STANDARD
  CURV -0.0078003120124805 0 0 0 0 ""
  DISZ 50
  DIAM 12.7 1 0 0 1 ""
SURF 4
  STOP
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 5
  GLAS N-BK7 0 0 1.5168 64.17 0 0 0 0 0 0
  DIAM 10 1 0 0 1 ""
SURF 5
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 20
  DIAM 10 1 0 0 1 ""
SURF 6
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DIAM 5 1 0 0 1 ""
"""


# A lens, a fold by 45 deg towards +y and, on that axis, an off-axis parabola of f = 200 mm with its aperture 30 mm off the
# axis: light on the axis of the lens ends in its focus. Object, lens, {...}, image.
BENCH = """VERS 181025 0 123457 L123457
MODE SEQ
UNIT MM X W X CM MR CPMM
ENPD 4
WAVM 1 1.064 1
PWAV 1
SURF 0
  TYPE STANDARD
  DISZ INFINITY
SURF 1
  TYPE EVENASPH
  CURV 0.01
  CONI -0.6
  PARM 2 1.0E-7
  PARM 3 -2.0E-11
  DISZ 5
  GLAS N-BK7 0 0 1.5168 64.17
  DIAM 12
SURF 2
  TYPE STANDARD
  CURV -0.002
  DISZ 100
  DIAM 12
SURF 3
  TYPE COORDBRK
  PARM 3 45
  DISZ 0
SURF 4
  TYPE STANDARD
  GLAS MIRROR
  DISZ 0
  DIAM 20
SURF 5
  TYPE COORDBRK
  PARM 3 45
  DISZ -150
SURF 6
  TYPE COORDBRK
  PARM 2 -30
  DISZ 0
SURF 7
  TYPE STANDARD
  CURV 0.0025
  CONI -1
  GLAS MIRROR
  OBDC 0 30
  DIAM 15
  DISZ 200
SURF 8
  TYPE STANDARD
  DIAM 5
"""


def converted(folder, name, text):
    (folder / name).write_text(text)
    assert layouts.main([str(folder / name), "-o", str(folder / "out.yaml")]) == 0
    return (folder / "out.yaml").read_text()


def rejected(folder, name, text, *reasons):
    (folder / name).write_text(text)
    try:
        scene_text(layouts.read_layout(folder / name), name)
    except LayoutError as error:
        for reason in reasons:
            assert reason in str(error), error
        return
    raise AssertionError(f"accepted; expected {reasons}")


def lit(program, scene):
    """Rows of `check`: surface, radius in mm, power, path in m, incidence in deg."""
    run = subprocess.run([program, "check", str(scene)], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr + run.stdout
    rows = {}
    for line in run.stdout.splitlines():
        words = re.split(r"\s{2,}", line.strip())
        if len(words) > 7 and words[1] not in ("surface", "---"):
            rows[words[1]] = dict(radius=words[3], power=float(words[4]), path=float(words[6]), angle=float(words[7].split()[0]))
    return rows


def check_theia(folder, program):
    converted(folder, "a.tia", TIA.format(wedge=0, r=0.98))
    rows = lit(program, folder / "out.yaml")
    assert abs(rows["M1/front"]["angle"] - 45) < 0.01 and abs(rows["M1/front"]["path"] - 1) < 1e-6, rows
    assert abs(rows["END/front"]["power"] - 0.98) < 1e-3 and abs(rows["END/front"]["path"] - 2) < 0.01
    # Gaussian optics: waist 1 mm, 1.4 m to a lens of 0.5 m, 0.6 m on: docs/theory/beams.md, eq. 6.2.
    q = complex(1.4, math.pi * 1e-6 / 1.064e-6)
    q = 1 / (1 / q - 1 / 0.5) + 0.6
    width = math.sqrt(-1.064e-6 / math.pi / (1 / q).imag) * 1e3
    assert abs(float(rows["END/front"]["radius"].split()[0]) / width - 1) < 0.02, (rows["END/front"], width)
    text = converted(folder, "b.tia", TIA.format(wedge=0, r=0.98).replace("50*cm", "-50*cm"))      # control: diverging
    other = lit(program, folder / "out.yaml")["END/front"]["radius"]
    assert abs(float(other.split()[0]) / width - 1) > 0.2 and "radius_1: -0.45" in text


def check_wedge(folder, program):
    """The normal of the back face, from the scene, is the one of theia: alpha 0 leans it towards the second axis."""
    text = converted(folder, "w.tia", TIA.format(wedge=1, r=0.98))
    axis, angle = re.search(r"axis: \[(.*?)\], angle: (\S+) rad", text).groups()
    axis, angle = np.array([float(v) for v in axis.split(",")]), float(angle)
    wedge = math.radians(1)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    back = turn @ np.array([-math.sin(wedge), 0, -math.cos(wedge)])
    normal = np.array([-math.sqrt(0.5), math.sqrt(0.5), 0])
    second = np.cross(normal, [0, 0, 1])
    np.testing.assert_allclose(back, -math.cos(wedge) * normal + math.sin(wedge) * second, atol=1e-9)
    assert np.abs(back - (-math.cos(wedge) * normal - math.sin(wedge) * second)).max() > 1e-3      # negative control
    assert abs(float(re.search(r"thickness: (\S+) m, wedge", text)[1]) - (0.02 + math.tan(wedge) * 0.05)) < 1e-9
    lit(program, folder / "out.yaml")
    for across in ([1, 0, 0], [0, 1, 0], [0, 0, 1]):     # quarter and half turns too
        for normal in np.vstack([np.eye(3), -np.eye(3)]):
            if abs(np.dot(normal, across)) < 0.5:
                axis, angle = rotation(np.array(normal), np.array(across, float))
                assert abs(np.linalg.norm(axis) - 1) < 1e-9 and 0 <= angle <= math.pi


def check_gtrace(folder, program):
    layout = dict(GTRACE)
    text = converted(folder, "g.json", json.dumps(layout))
    assert "add ports and an interferometer" in text
    with open(folder / "out.yaml", "a") as scene:
        scene.write("receivers: {PD: {on: M2/front, side: front}}\n")
    rows = lit(program, folder / "out.yaml")
    assert abs(rows["M1/front"]["angle"] - 45) < 0.01 and abs(rows["M2/front"]["path"] - 3) < 1e-6, rows
    # q = -0.5 + 2i: the waist of sqrt(2 lambda/pi) lies 0.5 m ahead.
    width = math.sqrt(2 * 1.064e-6 / math.pi * (1 + (2.5 / 2)**2)) * 1e3
    assert abs(float(rows["M2/front"]["radius"].split()[0]) / width - 1) < 0.01
    thickness = float(re.search(r"name: M2.*thickness: (\S+) m", text)[1])
    assert abs(thickness - (0.02 - 0.1 * 0.05**2 / 2)) < 1e-6     # concave: thinner in the middle. Control: thicker
    assert thickness < 0.02


def check_zemax(folder, program):
    """A cemented doublet and a window: the beam on the window by ray matrices of the surfaces, with the index of the catalogue."""
    (folder / "test.agf").write_bytes("NM SF5 2 673322 1.6727 32.21 0\nCD 1.46141885 0.0111826126 0.247713019 0.0508594669 0.949995832 112.041888\n"
                                      "LD 0.37 2.5\n".encode("utf-16"))
    (folder / "d.zmx").write_bytes(ZEMAX.encode("utf-16"))
    assert layouts.main([str(folder / "d.zmx"), "--glass", str(folder / "test.agf"), "-o", str(folder / "out.yaml")]) == 0
    text = (folder / "out.yaml").read_text()
    rows = lit(program, folder / "out.yaml")
    glasses = layouts.read_glasses([folder / "test.agf"])
    assert abs(glasses["SF5"].index(0.5876) - 1.67270) < 1e-5           # data sheet of Schott
    def width(flint):
        q, n = 1j * math.pi * (5e-3) ** 2 / 1.064e-6 + 0j, 1.0
        for curvature, behind, gap in ((1 / 62.8e-3, 1.50663, 4e-3), (-1 / 45.7e-3, flint, 2.5e-3), (-1 / 128.2e-3, 1.0, 50e-3)):
            q = 1 / (n / behind / q - (behind - n) * curvature / behind) + gap
            n = behind
        return math.sqrt(-1.064e-6 / math.pi / (1 / q).imag) * 1e3
    got = float(rows["L4/front"]["radius"].split()[0])
    assert abs(got / width(glasses["SF5"].index(1.064)) - 1) < 0.01, (got, width(glasses["SF5"].index(1.064)))
    assert abs(got / width(1.6727) - 1) > 0.01          # negative control: the index at 587.6 nm
    path = 0.15 + 4e-3 * 1.50663 + 2.5e-3 * glasses["SF5"].index(1.064)
    assert abs(rows["L4/front"]["path"] - path) < 1e-6 and "medium: bk7" in text and "image:" in text
    (folder / "d.zmx").write_text(ZEMAX)                # UTF-8
    assert scene_text(layouts.read_layout(folder / "d.zmx", [folder / "test.agf"]), "d.zmx") == text
    rejected(folder, "x.zmx", ZEMAX, "x.zmx:20: error: surface 2: the glass SF5 is not known", "--glass")
    for before, after, reason in (("MODE SEQ", "MODE NSC", "only sequential"), ("UNIT MM", "UNIT FT", "unit 'FT'"),
                                  ("DISZ 4.0", "DISZ 4,0", "'4,0' is not a number"), ("DIAM 12.7", "DIAM 0", "semi-diameter 0"), ("DISZ 4.0", "DISZ -4.0", "negative after an odd number of mirrors"), ("CURV 0.0159235668789809", "CURV 0.1", "wider than the sphere")):
        rejected(folder, "x.zmx", ZEMAX.replace(before, after).replace("SF5", "BK7"), reason)


def check_bench(folder, program):
    """Mirrors, coordinate breaks and aspheres: path and incidence of the chief ray, widths by ray matrices."""
    text = converted(folder, "bench.zmx", BENCH)
    rows = lit(program, folder / "out.yaml")
    assert abs(rows["M4"]["angle"] - 45) < 1e-3 and abs(rows["M4"]["path"] - 0.2 - 5e-3 * 1.50663) < 1e-5, rows
    # Parabola, focus at f, ray at the height d: incidence atan(d/(2f)); the sag d^2/(4f) is left out of the way there.
    assert abs(rows["M7"]["angle"] - math.degrees(math.atan(30 / 400))) < 0.01, rows["M7"]
    assert abs(rows["M7"]["path"] - rows["M4"]["path"] - 0.15 + 0.030**2 / 0.8) < 1e-5, rows["M7"]
    q = 1j * math.pi * (2e-3)**2 / 1.064e-6 + 0j
    for n, behind, curvature, gap in ((1.0, 1.50663, 10.0, 5e-3), (1.50663, 1.0, -2.0, 0.1)):
        q = 1 / (n / behind / q - (behind - n) * curvature / behind) + gap
    width = math.sqrt(-1.064e-6 / math.pi / (1 / q).imag) * 1e3
    assert abs(float(rows["M4"]["radius"].split()[0]) / width - 1) < 0.01, (rows["M4"], width)
    for face in ("curvature: -10 /m, conic_constant: -0.6, a4: -100 /m^3, a6: 20000 /m^5", "curvature: -2 /m"):
        assert face in text, text
    # The image lies where the chief ray passes the focus, f from the vertex; a ray beside its axis has the height 0 there.
    layout = layouts.read_layout(folder / "bench.zmx")
    parabola, image = layout.shaped[-1], layout.planes[-1]
    np.testing.assert_allclose(image.at - parabola.vertex, 0.2 * parabola.normal, atol=1e-12)
    np.testing.assert_allclose(parabola.normal, [0, -1, 0], atol=1e-12)
    np.testing.assert_allclose(parabola.vertex, [0, 0.15, 0.105 - 0.03], atol=1e-12)
    other = layouts.read_layout(written(folder, "x.zmx", BENCH.replace("PARM 2 -30", "PARM 2 30")))      # control: moved to the other side
    np.testing.assert_allclose(other.shaped[-1].vertex, [0, 0.15, 0.105 + 0.03], atol=1e-12)


def check_zemax_limits(folder):
    """What a scene cannot express is an error or a note, each with its line."""
    def notes(before, after):
        layout = layouts.read_layout(written(folder, "x.zmx", BENCH.replace(before, after, 1)))
        return [o.name for o in layout.shaped], "\n".join(layout.left_out)
    assert notes("", "")[0] == ["L1", "M4", "M7"] and "x.zmx" not in notes("", "")[1]
    for before, after, note in (("PARM 3 -2.0E-11", "PARM 6 -2.0E-11", "x.zmx:10: surface 1 begins a lens with a face that has the aspheric term r^12"),
                                ("TYPE EVENASPH", "TYPE TOROIDAL", "is of type TOROIDAL"), ("CURV 0.01", "CURV 0.01\n  PARM 1 1E-5", "r^2")):
        names, told = notes(before, after)
        assert names == ["M4", "M7"] and note in told and "STEP" in told, told
    for before, after, note in (("DIAM 20", "DIAM 20\n  SQAP 10 10 0", "x.zmx:33: surface 4: SQAP is not read"), ("PWAV 1", "PWAV 1\nYFLN 0 1.5 0", "field points"),
                                ("  PARM 2 -30", "  PARM 2 -30\n  SCBD 1 0 2", "SCBD is not read")):
        names, told = notes(before, after)
        assert len(names) == 3 and note in told, told
    plane = BENCH.replace("SURF 3\n", "SURF 3\n  TYPE PARAXIAL\n  PARM 1 100\n  DISZ 0\nSURF 4\n")
    assert "surface 3 is of type PARAXIAL" in "".join(layouts.read_layout(written(folder, "x.zmx", plane)).left_out)
    stop = BENCH.replace("SURF 3\n", "SURF 3\n  STOP\n  TYPE STANDARD\n  DIAM 3\n  DISZ 0\nSURF 4\n")
    assert "surface 3 is an aperture stop of radius 3" in "".join(layouts.read_layout(written(folder, "x.zmx", stop)).left_out)
    for before, after, reason in (("SURF 2\n  TYPE STANDARD", "SURF 2\n  TYPE COORDBRK", "x.zmx:10: error: surface 1 is glass whose other face is tilted"),
                                  ("CURV 0.0025\n  CONI -1", "CURV 0.0025\n  CONI 200", "surface 7 is a mirror wider"),
                                  ("TYPE STANDARD\n  CURV 0.0025", "TYPE BICONICX\n  CURV 0.0025", "surface 7 is a mirror and is of type BICONICX"),
                                  ("DISZ 200", "DISZ INFINITY", "infinite thickness"), ("OBDC 0 30\n  DIAM 15", "OBDC 0 30", "semi-diameter 0")):
        rejected(folder, "x.zmx", BENCH.replace(before, after), reason)
    # A lens, a mirror behind it, and the lens again on the way back: one lens. A parabola by its r^2 term.
    double = BENCH[:BENCH.index("SURF 3")] + """SURF 3
  TYPE EVENASPH
  PARM 1 0.00125
  GLAS MIRROR
  CLAP 2 10
  DISZ -100
SURF 4
  TYPE STANDARD
  CURV -0.002
  GLAS N-BK7
  DIAM 12
  DISZ -5
SURF 5
  TYPE EVENASPH
  CURV 0.01
  CONI -0.6
  DIAM 12
  DISZ -50
SURF 6
  DIAM 5
"""
    layout = layouts.read_layout(written(folder, "x.zmx", double))
    assert [o.name for o in layout.shaped] == ["L1", "M3"] and "surface 4 begins a lens that the light has passed before" in "".join(layout.left_out)
    assert layout.shaped[1].front.shape(0.01, layout.shaped[1].hole) == "{conic: {outer_radius: 0.01 m, inner_radius: 0.002 m, curvature: -2.5 /m, conic_constant: -1}}"
    np.testing.assert_allclose(layout.planes[-1].at, [0, 0, -0.05], atol=1e-12)


def written(folder, name, text):
    (folder / name).write_text(text)
    return folder / name


def check_errors(folder):
    good = TIA.format(wedge=0, r=0.98)
    rejected(folder, "x.tia", TIA.format(wedge=0, r=1.2), "x.tia:6:1: error: 'M1', front (HR): R = 1.2, T = 0.01")
    rejected(folder, "x.tia", good.replace("HRK = 0", "HRC = 0"), "x.tia:6:1", "has no 'HRC'")
    rejected(folder, "x.tia", good.replace("10*cm", "10*inch"), "'inch' is neither")
    rejected(folder, "x.tia", good.replace("Focal = 50*cm", "Focal = 0"), "x.tia:7:1", "focal length 0")
    rejected(folder, "x.tia", good.replace("bd 0", "xx 0"), "x.tia:8:1: error: unknown keyword 'xx'")
    rejected(folder, "x.tia", good.replace("1*m, 0, 0", "1*m; 0"), "x.tia:5:", "cannot read")
    rejected(folder, "x.tia", good.replace("P = 2*W", "P = 1/0"), "x.tia:4:1")
    rejected(folder, "x.tia", "title\nbm\n", "holds no optic")
    for key, value, reason in (("Refl_HR", 1.5, "R = 1.5"), ("n", None, "'n' is missing"), ("HRcenter", [1], "2 finite numbers"),
                               ("type", "Prism", "unknown type 'Prism'"), ("inv_ROC_HR", 100.0, "wider than the sphere")):
        layout = json.loads(json.dumps(GTRACE))
        layout["optics"][1][key] = value
        rejected(folder, "x.json", json.dumps(layout), reason)
    rejected(folder, "x.json", "{,}", "x.json:1:2")
    rejected(folder, "x.json", "{}", "no list 'optics'")
    cylinder = json.loads(json.dumps(GTRACE))
    cylinder["optics"][1]["type"] = "CyMirror"
    (folder / "c.json").write_text(json.dumps(cylinder))
    assert any("cylindrical" in note for note in layouts.read_layout(folder / "c.json").left_out)


with tempfile.TemporaryDirectory() as name:
    here = pathlib.Path(name)
    check_theia(here, sys.argv[1])
    check_wedge(here, sys.argv[1])
    check_gtrace(here, sys.argv[1])
    check_zemax(here, sys.argv[1])
    check_bench(here, sys.argv[1])
    check_zemax_limits(here)
    check_errors(here)
print("ok")
