#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What packages contain: every library that the programs load, with its licence; the recipe for conda-forge names what the build
needs. scripts/package --test installs and runs them. Usage: test_package.py BUILD_DIR"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools/package"))
sys.dont_write_bytecode = True
BUILD = pathlib.Path(sys.argv.pop(1)).resolve()

import bundle  # noqa: E402

# In the recipe under another name than in find_package or find_path.
OTHER_NAMES = {"fmt": "fmt", "yaml-cpp": "yaml-cpp", "CLI11": "cli11", "Eigen3": "eigen", "Boost": "libboost-headers",
               "nlohmann_json": "nlohmann_json", "assimp": "assimp", "OpenSSL": "openssl", "PNG": "libpng", "ZLIB": "zlib", "NLopt": "nlopt",
               "HDF5": "hdf5", "meshoptimizer": "meshoptimizer", "OpenCASCADE": "occt", "Threads": None, "Python3": "python", "GTest": None,
               "MPI": None}


class Packages(unittest.TestCase):

    def test_all_libraries_with_licences(self):
        program = BUILD / "straytrace"
        found = bundle.libraries([program])
        needed = set(re.findall(r"NEEDED\s+(\S+)", subprocess.run(["objdump", "-p", program], check=True, capture_output=True, text=True).stdout))
        needed.discard(bundle.LOADER)
        self.assertGreater(len(needed), 5)
        self.assertEqual(needed - set(found), set())
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            bundle.licences(folder, "1.2.3", 0, found)
            told = (folder / "LICENCES.spdx").read_text(encoding="utf-8")
            for name in found:
                self.assertIn(name, told)
            for package in re.findall(r"^PackageName: (\S+)$", told, re.MULTILINE)[1:]:
                self.assertGreater((folder / "licences" / package).stat().st_size, 100, package)
            self.assertIn("PackageName: libhdf5", told)
            self.assertIn("Created: 1970-01-01T00:00:00Z", told)

    def test_a_library_of_no_package(self):
        with tempfile.NamedTemporaryFile() as file, self.assertRaisesRegex(SystemExit, "no package has"):
            bundle.package_of(file.name)

    def test_recipe(self):
        recipe = (ROOT / "packaging/meta.yaml").read_text(encoding="utf-8")
        version = re.search(r"straytrace VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
        self.assertIn(f'version = "{version}"', recipe)
        sources = "\n".join((ROOT / name).read_text() for name in ("CMakeLists.txt", "src/CMakeLists.txt", "step/CMakeLists.txt"))
        for name in set(re.findall(r"find_package\((\w[\w-]*)", sources)):
            if (other := OTHER_NAMES[name]) is not None:
                self.assertRegex(recipe, rf"(?m)^    - {re.escape(other)}( |$)")
        python = re.search(r'requires-python = ">=([\d.]+)"', (ROOT / "pyproject.toml").read_text()).group(1)
        self.assertIn(f"- python >={python}", recipe)


if __name__ == "__main__":
    unittest.main()
