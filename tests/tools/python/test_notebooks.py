# SPDX-License-Identifier: BSD-3-Clause
"""Runs the notebooks of examples/notebooks as they are; none holds outputs."""
import os
import pathlib
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

from python_arm import SOURCE

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError


def stored(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code" and (cell.outputs or cell.execution_count)]


def executed(path):
    """Faults of a notebook, and its pictures."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    if stored(notebook):
        return f"{path.name} holds outputs: clear them", 0
    with tempfile.TemporaryDirectory() as folder:
        try:
            NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": folder}}).execute()
        except CellExecutionError as error:
            return f"{path.name}: {error}", 0
    shown = [out.get("data", {}) for cell in notebook.cells for out in cell.get("outputs", [])]
    if path.name.startswith("first") and not any(data.get("text/plain", "").startswith("trace  ") for data in shown):
        return f"{path.name} does not show how far it is", 0
    return "", sum("image/png" in data for data in shown)


def main():
    os.environ["PYTHONPATH"] = str(SOURCE / "python")
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    paths = sorted((SOURCE / "examples" / "notebooks").glob("*.ipynb"))
    assert len(paths) >= 3, paths
    control = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("import straytrace\nstraytrace.nothing")])
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        bad = pathlib.Path(folder, "control.ipynb")
        nbformat.write(control, bad)
        answers = list(pool.map(executed, [*paths, bad]))
    assert "nothing" in answers.pop()[0]
    problems = [problem for problem, _ in answers if problem]
    assert not problems, "\n".join(problems)
    assert all(pictures == 1 for _, pictures in answers), answers     # each draws one, once
    print(f"{len(paths)} notebooks: as expected")


main()
