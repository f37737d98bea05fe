#!/usr/bin/env python3
"""Draw the pictures of docs/reference/scatter: the law of each page's example, by `straytrace inspect --plot`.

Usage: draw_laws.py PROGRAM [PAGE...]
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ROOT / "docs" / "reference" / "scatter"
BLOCK = re.compile(r"^```yaml\n(straytrace:.*?)^```$", re.MULTILINE | re.DOTALL)
ON_THE_MIRROR = ("power-law", "psd", "defects")    # pages whose law is that of the material `mirror`, not `steel`
WITHOUT = ("grooves", "interfaces", "measured_files")    # draw_grooves.py and draw_guides.sh draw what they show
LARGEST = 60_000                                    # bytes


def main(program, wanted):
    for page in sorted(PAGES.glob("*.md")):
        if page.stem in WITHOUT or (wanted and page.stem not in wanted):
            continue
        block = BLOCK.search(page.read_text(encoding="utf-8"))
        if block is None:
            sys.exit(f"{page}: no complete scene")
        picture = page.with_suffix(".png")
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "examples").symlink_to(ROOT / "examples")
            (pathlib.Path(folder) / "page.yaml").write_text(block.group(1), encoding="utf-8")
            material = "mirror" if page.stem in ON_THE_MIRROR else "steel"
            command = [str(pathlib.Path(program).resolve()), "inspect", material, "page.yaml", "--quiet", "--plot", str(picture)]
            done = subprocess.run(command, cwd=folder, text=True, capture_output=True)
            if done.returncode:
                sys.exit(f"{page}: {done.stderr}")
        size = picture.stat().st_size
        print(f"{picture.relative_to(ROOT)}: {size} bytes")
        if size > LARGEST:
            sys.exit(f"{picture}: larger than {LARGEST} bytes")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
