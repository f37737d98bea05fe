# SPDX-License-Identifier: BSD-3-Clause
"""Runs the notebooks of examples/notebooks and compares what they print with the outputs that they hold; with --write, stores these."""
import base64
import io
import os
import pathlib
import re
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

from python_arm import SOURCE

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from PIL import Image

PROGRESS = re.compile(r"^trace  .*", re.DOTALL)           # comes with the clock
PLACE = re.compile(r"0x[0-9a-f]+|/tmp/ipykernel_\d+/\d+\.py")  # differ between two equal runs


def printed(cell):
    """Text of each output, and whether it has a picture. HTML and pixels are left to the libraries that draw them."""
    for out in cell.get("outputs", []):
        data = out.get("data", {})
        yield PLACE.sub("cell", PROGRESS.sub("trace", out.get("text") or data.get("text/plain", ""))), "image/png" in data


def differences(held, fresh):
    for number, (old, new) in enumerate(zip(held.cells, fresh.cells)):
        if list(printed(old)) != list(printed(new)):
            yield f"cell {number} holds {list(printed(old))} and prints {list(printed(new))}"


def small(cell):
    """A cell without places, whose pictures have 64 colours."""
    for out in cell.get("outputs", []):
        data = out.get("data", {})
        if "text" in out:
            out["text"] = PLACE.sub("cell", out["text"])
        if "image/png" in data:
            stream = io.BytesIO()
            Image.open(io.BytesIO(base64.b64decode(data["image/png"]))).convert("RGB").quantize(64).save(stream, "PNG", optimize=True)
            data["image/png"] = base64.b64encode(stream.getvalue()).decode()
    return cell


def executed(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=300, kernel_name="python3", record_timing=False, resources={"metadata": {"path": folder}}).execute()
    return notebook


def faults(path):
    """What is wrong with a notebook, and the number of its pictures."""
    held = nbformat.read(path, as_version=4)
    try:
        fresh = executed(path)
    except CellExecutionError as error:
        return f"{path.name}: {error}", 0
    shown = [output for cell in fresh.cells for output in printed(cell)]
    if path.name.startswith("first") and ("trace", False) not in shown:
        return f"{path.name} does not show how far it is", 0
    wrong = [f"{path.name}: {problem}; store its outputs anew with --write" for problem in differences(held, fresh)]
    return "\n".join(wrong), sum(picture for _, picture in shown)


def write(path):
    held, fresh = nbformat.read(path, as_version=4), executed(path)
    held.cells = [small(cell) for cell in fresh.cells]
    nbformat.write(held, path)


def controls(folder):
    """Notebooks that must fail: an error, and an output that is not what the cell prints."""
    broken = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("import straytrace\nstraytrace.nothing")])
    stale = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("print(1)")])
    stale.cells[0].outputs = [nbformat.v4.new_output("stream", text="2\n")]
    for name, notebook in (("broken", broken), ("stale", stale)):
        nbformat.write(notebook, folder / f"{name}.ipynb")
        yield folder / f"{name}.ipynb"


def main():
    os.environ["PYTHONPATH"] = str(SOURCE / "python")
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    paths = sorted((SOURCE / "examples" / "notebooks").glob("*.ipynb"))
    assert len(paths) >= 3, paths
    if "--write" in sys.argv:
        return [write(path) for path in paths]
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        *answers, broken, stale = pool.map(faults, [*paths, *controls(pathlib.Path(folder))])
    assert "nothing" in broken[0] and "holds [('2\\n', False)]" in stale[0], (broken, stale)
    problems = [problem for problem, _ in answers if problem]
    assert not problems, "\n".join(problems)
    assert all(pictures == 1 for _, pictures in answers), answers     # each draws one, once
    return print(f"{len(paths)} notebooks: as expected")


main()
