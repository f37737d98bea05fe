"""Shared by the tools that draw the pictures of the documents."""
import pathlib
import sys

from PIL import Image, PngImagePlugin

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))

from straytrace.plots.style import TERM_COLOURS, ROUTE_COLOURS  # noqa: E402

CURVES = (*ROUTE_COLOURS, *TERM_COLOURS.values(), "#000000", "#6b6b6b", "#ffffff")   # distinguishable in any picture


def with_palette(image, colours):
    """In so many colours, the curves' own among them: thin lines have few pixels, and would share a colour."""
    own = list(dict.fromkeys(bytes.fromhex(c[1:]) for c in CURVES))
    found = image.quantize(colours - len(own)).getpalette()[:3 * (colours - len(own))]
    palette = Image.new("P", (1, 1))
    palette.putpalette([*found, *b"".join(own)])
    mapped = image.quantize(palette=palette, dither=Image.Dither.NONE)
    corner = mapped.getpixel((0, 0))
    exact = mapped.getpalette()
    exact[3 * corner:3 * corner + 3] = image.getpixel((0, 0))          # the background keeps its colour
    mapped.putpalette(exact)
    return mapped


def small(picture, to, width=None, colours=256):
    """Rewrites a PNG file, smaller, with its text chunks."""
    image = Image.open(picture)
    words = PngImagePlugin.PngInfo()
    for key, text in image.text.items():
        words.add_text(key, text)
    image = image.convert("RGB")
    if width and width < image.width:
        image = image.resize((width, round(image.height * width / image.width)), Image.LANCZOS)
    with_palette(image, colours).save(to, optimize=True, pnginfo=words)
    print(f"{pathlib.Path(to).name}: {pathlib.Path(to).stat().st_size} bytes")
