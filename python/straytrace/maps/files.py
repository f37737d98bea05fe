# SPDX-License-Identifier: BSD-3-Clause
"""Reads maps of mirror surfaces, chosen by their content: MetroPro .dat, Zygo .asc and .xyz, LIGO _asc.dat, FINESSE and pykat
maps, matrices of numbers (OSCAR)."""

from __future__ import annotations

import dataclasses
import pathlib
import struct

import numpy as np

MAGIC = {0x881B036F: (1, 834), 0x881B0370: (2, 834), 0x881B0371: (3, 4096)}   # number: header format, header bytes
INVALID = 2147483640                                                        # phase of pixels without data
RESOLUTION = {0: 4096, 1: 32768, 2: 131072}                                 # counts per fringe, by the phase_res of the header
TITLE = "Zygo ASCII Data File", "Zygo XYZ Data File"
FINESSE = "% Surface map"
HEADER_LINES = 14


class MapError(ValueError):
    """The file is invalid; the text states the place and a remedy."""


@dataclasses.dataclass
class MirrorMap:
    """Heights of a surface in m, towards the instrument; rows from the top; NaN where nothing was measured."""

    height: np.ndarray
    pixel: float                       # m; 0: not in the file
    kind: str                          # format
    wavelength: float                  # of the instrument in m; 0 where the file gives heights
    scale: str                         # how counts became heights
    centre: tuple[float, float] = (0.0, 0.0)   # of the optic from the middle of the map, m: x to the right, y upwards


def height_per_count(scale_factor: float, obliquity: float, wavelength: float, resolution: int) -> float:
    """Height of one count in m: the interference factor (0.5: in reflection, half a wavelength per fringe) times
    obliquity times wavelength, over the counts per fringe."""
    return scale_factor * obliquity * wavelength / resolution


def counts_to_map(path, counts, header, kind) -> MirrorMap:
    """Scales counts; `header` holds scale_factor, obliquity, wavelength, phase_res, pixel."""
    for name, what in (("scale_factor", "the interference scale factor"), ("wavelength", "the wavelength"),
                       ("obliquity", "the obliquity factor")):
        if not (np.isfinite(header[name]) and 0 < header[name] < 100):
            raise MapError(f"{path}: {what} of the header is {header[name]:g}; export the map again")
    if header["phase_res"] not in RESOLUTION:
        raise MapError(f"{path}: phase resolution {header['phase_res']} is not 0, 1 or 2; export the map again")
    resolution = RESOLUTION[header["phase_res"]]
    one = height_per_count(header["scale_factor"], header["obliquity"], header["wavelength"], resolution)
    height = np.where(counts >= INVALID, np.nan, counts * one)
    scale = (f"{header['scale_factor']:g} x {header['wavelength'] * 1e9:.6g} nm x obliquity {header['obliquity']:g} / "
             f"{resolution} per count")
    return MirrorMap(height, header["pixel"], kind, header["wavelength"], scale)


def read_metropro(path, data: bytes) -> MirrorMap:
    magic, version, size = struct.unpack(">IhI", data[:10])
    if MAGIC.get(magic) != (version, size):
        raise MapError(f"{path}: MetroPro with header format {version} of {size} bytes, which is not one of the three known ones")
    if len(data) < size:
        raise MapError(f"{path}: ends within its header; copy the file again")
    intensity_bytes, = struct.unpack(">i", data[60:64])
    width, height = struct.unpack(">hh", data[68:72])
    scale_factor, wavelength = struct.unpack(">ff", data[164:172])
    obliquity, = struct.unpack(">f", data[176:180])
    pixel, = struct.unpack(">f", data[184:188])
    phase_res, = struct.unpack(">h", data[218:220])
    begin, count = size + intensity_bytes, width * height
    if count <= 0:
        raise MapError(f"{path}: no phase data ({width} x {height} pixels); save the map, not the intensity alone")
    if len(data) < begin + 4 * count:
        raise MapError(f"{path}: {(len(data) - begin) // 4} of {count} pixels; copy the file again")
    counts = np.frombuffer(data, ">i4", count, begin).astype(float).reshape(height, width)
    header = dict(scale_factor=scale_factor, wavelength=wavelength, obliquity=obliquity, pixel=float(pixel),
                  phase_res=phase_res)
    return counts_to_map(path, counts, header, "MetroPro")


def numbers_of(path, line, number, least):
    words = line.split()
    try:
        values = [float(w) for w in words[:least]]
    except ValueError:
        raise MapError(f"{path}:{number}:1: '{line.strip()[:40]}' should begin with {least} numbers") from None
    if len(values) < least:
        raise MapError(f"{path}:{number}:1: {len(values)} numbers, expected {least}")
    return values


def text_header(path, lines):
    if len(lines) < HEADER_LINES:
        raise MapError(f"{path}: ends within its header of {HEADER_LINES} lines; copy the file again")
    phase = numbers_of(path, lines[3], 4, 4)
    optics = numbers_of(path, lines[7], 8, 7)
    resolution = numbers_of(path, lines[10], 11, 1)
    return dict(width=int(phase[2]), height=int(phase[3]), scale_factor=optics[1], wavelength=optics[2],
                obliquity=optics[4], pixel=optics[6], phase_res=int(resolution[0]))


def read_zygo_text(path, text: str) -> MirrorMap:
    """Blocks of numbers between lines '#': the intensities, if any, and then the phase, row by row."""
    lines = text.splitlines()
    header = text_header(path, lines)
    wanted = header["width"] * header["height"]
    blocks = [b for b in "\n".join(lines[HEADER_LINES:]).split("#") if b.strip()]
    for block in reversed(blocks):
        words = block.split()
        if len(words) != wanted:
            continue
        try:
            counts = np.array(words, dtype=float)
        except ValueError as error:
            hint = "; use decimal points, not decimal commas" if "," in block else ""
            raise MapError(f"{path}: phase data: {error}{hint}") from None
        return counts_to_map(path, counts.reshape(header["height"], header["width"]), header, "Zygo ASCII")
    sizes = ", ".join(str(len(b.split())) for b in blocks) or "no"
    raise MapError(f"{path}: {header['width']} x {header['height']} = {wanted} phases should follow the header, but there "
                   f"are blocks of {sizes} numbers; the file is cut off")


def read_zygo_xyz(path, text: str) -> MirrorMap:
    """Rows 'column row height', height in micrometres or the words 'No Data'."""
    lines = text.splitlines()
    header = text_header(path, lines)
    height = np.full((header["height"], header["width"]), np.nan)
    for number, line in enumerate(lines[HEADER_LINES:], HEADER_LINES + 1):
        words = line.split()
        if not words or words[0] == "#":
            continue
        if words[2:] == ["No", "Data"]:
            continue
        column, row, value = numbers_of(path, line, number, 3)
        if not (0 <= row < height.shape[0] and 0 <= column < height.shape[1]):
            raise MapError(f"{path}:{number}:1: pixel {column:g}, {row:g} is outside {header['width']} x {header['height']}")
        height[int(row), int(column)] = value * 1e-6
    return MirrorMap(height, header["pixel"], "Zygo XYZ", 0.0, "heights in micrometres")


def matrix_of(path, lines) -> np.ndarray:
    """Rows of as many numbers; '%' and '#' begin comments. `lines`: with their numbers."""
    rows = []
    for number, line in lines:
        words = line.split("%")[0].split("#")[0].replace(",", " ").split()
        try:
            row = [float(w) for w in words]
        except ValueError as error:
            raise MapError(f"{path}:{number}:1: {error}; write rows of numbers with decimal points") from None
        if row and rows and len(row) != len(rows[0]):
            raise MapError(f"{path}:{number}:1: {len(row)} numbers, the rows before have {len(rows[0])}")
        if row:
            rows.append(row)
    if not rows:
        raise MapError(f"{path}: no numbers in it; export the map again")
    return np.array(rows)


def read_finesse(path, text: str) -> MirrorMap:
    """FINESSE and pykat: a header of lines '% Name: value', then rows from the lowest y, in units of the scaling. Heights
    are positive towards light that arrives at the first node."""
    lines = list(enumerate(text.splitlines(), 1))
    header = {}
    for number, line in lines:
        name, colon, value = line.lstrip("% ").partition(": ")
        if line.startswith("%") and colon:
            header[name.lower()] = number, value

    def numbers(name, count):
        number, value = header.get(name, (0, ""))
        if not number:
            raise MapError(f"{path}: the header has no line '% {name.capitalize()}: '; export the map again")
        return numbers_of(path, value, number, count)

    kind = header.get("type", (0, "phase"))[1]
    if "phase" not in kind:
        raise MapError(f"{path}:{header['type'][0]}:1: a map of type '{kind}' has no heights; give one of type 'phase'")
    centre = numbers("optical center (x,y)", 2)
    step, step_y = numbers("step size (x,y)", 2)
    scaling, = numbers("scaling", 1)
    if not (step > 0 and abs(step_y / step - 1) < 1e-6):
        raise MapError(f"{path}: steps of {step:g} and {step_y:g} m; give a map of square pixels")
    height = matrix_of(path, lines)[::-1] * scaling
    middle = [(n + 1) / 2 for n in height.shape[::-1]]      # the first pixel is number 1
    return MirrorMap(height, step, "FINESSE", 0.0, f"heights times {scaling:g} m",
                     tuple((c - m) * step for c, m in zip(centre, middle)))


def read_matrix(path, text: str) -> MirrorMap:
    """A matrix of heights in m, as OSCAR loads it: rows from the lowest y, towards the light."""
    height = matrix_of(path, enumerate(text.splitlines(), 1))
    if min(height.shape) < 8:
        raise MapError(f"{path}: a matrix of {height.shape[1]} x {height.shape[0]} numbers is no map; give 8 x 8 or more")
    return MirrorMap(height[::-1], 0.0, "matrix", 0.0, "heights in m")


def is_matrix(text: str) -> bool:
    """Whether the first line that is no comment begins with a number."""
    for line in text.splitlines():
        words = line.split("%")[0].split("#")[0].replace(",", " ").split()
        if words:
            try:
                float(words[0])
            except ValueError:
                return False
            return True
    return False


def read_map(path) -> MirrorMap:
    """The map in a file. MapError explains errors."""
    data = pathlib.Path(path).read_bytes()
    if len(data) >= 220 and struct.unpack(">I", data[:4])[0] in MAGIC:
        result = read_metropro(path, data)
    else:
        text = data.decode("latin-1")
        if text.startswith(TITLE[0]):
            result = read_zygo_text(path, text)
        elif text.startswith(TITLE[1]):
            result = read_zygo_xyz(path, text)
        elif text.startswith(FINESSE):
            result = read_finesse(path, text)
        elif is_matrix(text):
            result = read_matrix(path, text)
        else:
            raise MapError(f"{path}: no known map: MetroPro .dat begins with 88 1B 03, Zygo .asc and LIGO _asc.dat with "
                           f"'{TITLE[0]}', .xyz with '{TITLE[1]}', FINESSE with '{FINESSE}', a matrix with a number; export it "
                           f"as one of them")
    if not np.isfinite(result.height).any():
        raise MapError(f"{path}: no pixel has data; check the mask of the measurement")
    return result
