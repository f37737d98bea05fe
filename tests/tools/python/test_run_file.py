#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A run of the program as Python users read it. Usage: test_run_file.py RUN_FILE H_ASD_TXT"""
import pathlib
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "python"))
sys.dont_write_bytecode = True

import h5py  # noqa: E402
import numpy as np  # noqa: E402

import straytrace  # noqa: E402

run = straytrace.open(sys.argv[1])
assert len(run.routes.name) > 0 and len(run.routes.name) == len(run.noise.routes)

frequency, h = np.loadtxt(sys.argv[2], usecols=(0, 1), unpack=True)
np.testing.assert_allclose(frequency, run.noise.frequency, rtol=1e-9)
np.testing.assert_allclose(h, run.noise.total.mean, rtol=1e-9)
assert not np.allclose(h, run.noise.total.phase, rtol=1e-3, atol=0)  # control: another column

# Powers of routes add, and the two quadratures of each do (docs/reference/run_file.md).
square = sum(r.mean**2 for r in run.noise.routes if r.resolved)
np.testing.assert_allclose(np.sqrt(square), h, rtol=1e-9)
np.testing.assert_allclose(np.hypot(run.noise.total.phase, run.noise.total.amplitude), h, rtol=1e-9)

# Every path of the file is in the schema, and carries its unit or meaning.
schema = (SOURCE / "schema/run-2.txt").read_text().split()
with h5py.File(sys.argv[1], "r") as file:
    def described(path, item):
        known = "/input/files/<n>" if path.startswith("input/files/") else "/" + path
        assert known in schema, f"{path} is not in schema/run-2.txt"
        assert ("unit" if isinstance(item, h5py.Dataset) else "meaning") in item.attrs, path

    file.visititems(described)
print("run file: as expected")
