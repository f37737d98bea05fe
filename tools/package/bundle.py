#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Copies programs with the shared libraries that they load, and what starts them, into a folder; lists their licences.

Usage: bundle.py STARTER FOLDER PROGRAM...

FOLDER/bin gets STARTER under the name of each program, and the loader; FOLDER/lib the libraries, without symbols;
FOLDER/lib/programs the programs; FOLDER/licences the texts, and LICENCES.spdx, which lists all in SPDX 2.3."""
import datetime
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys

# Compiled into the programs: package of Debian with its licence.
BUILT_IN = {"libeigen3-dev": "MPL-2.0", "libcli11-dev": "BSD-3-Clause", "nlohmann-json3-dev": "MIT", "libboost-dev": "BSL-1.0",
            "libboost1.81-dev": "BSL-1.0", "librandom123-dev": "BSD-3-Clause", "libmeshoptimizer-dev": "MIT", "node-d3": "BSD-3-Clause",
            "libjs-three": "MIT"}
LICENCES = {"libc6": "LGPL-2.1-or-later", "libgcc-s1": "GPL-3.0-with-GCC-exception", "libstdc++6": "GPL-3.0-with-GCC-exception",
            "libfmt9": "MIT", "libyaml-cpp0.7": "MIT", "libssl3": "Apache-2.0", "libpng16-16": "libpng-2.0", "zlib1g": "Zlib",
            "libnlopt0": "LGPL-2.1-or-later", "libhdf5-103-1": "BSD-3-Clause", "libassimp5": "BSD-3-Clause"}
LOADER = "ld-linux-x86-64.so.2"


def output(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def libraries(programs):
    """The files that the loader takes for them, by the name under which it looks for them."""
    found = {}
    for program in programs:
        for name, path in re.findall(r"^\s*(\S+) => (/\S+) \(", output("ldd", program), re.MULTILINE):
            found[name] = pathlib.Path(path)
    return found


def package_of(file):
    """Of Debian, with its version; also where /lib is a link to /usr/lib."""
    real = str(pathlib.Path(file).resolve())
    for name in (real, real.removeprefix("/usr"), str(file)):
        told = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True, check=False)
        if told.returncode == 0:
            package = told.stdout.split(":")[0]
            return package, output("dpkg-query", "-W", "-f=${Version}", package)
    sys.exit(f"bundle: no package has {file}")


def licence_file(package):
    path = pathlib.Path("/usr/share/doc", package, "copyright")
    if not path.exists():
        sys.exit(f"bundle: {path} is missing: a licence cannot be listed")
    return path.resolve()


def identifier(text):
    return re.sub(r"[^A-Za-z0-9.-]", "-", text)


def write_spdx(place, version, epoch, packages):
    """packages: (name, version, licence, files)."""
    made = datetime.datetime.fromtimestamp(epoch, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    lines = ["SPDXVersion: SPDX-2.3", "DataLicense: CC0-1.0", "SPDXID: SPDXRef-DOCUMENT", f"DocumentName: straytrace-{version}",
             f"DocumentNamespace: https://spdx.org/spdxdocs/straytrace-{version}-{epoch}", "Creator: Tool: straytrace tools/package/bundle.py",
             f"Created: {made}", "", "PackageName: straytrace", "SPDXID: SPDXRef-straytrace", f"PackageVersion: {version}",
             "PackageDownloadLocation: NOASSERTION", "FilesAnalyzed: false", "PackageLicenseConcluded: BSD-3-Clause",
             "PackageLicenseDeclared: BSD-3-Clause", "PackageCopyrightText: the straytrace authors",
             "Relationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-straytrace"]
    for name, its_version, licence, files in packages:
        reference = "SPDXRef-" + identifier(name)
        lines += ["", f"PackageName: {name}", f"SPDXID: {reference}", f"PackageVersion: {its_version}",
                  "PackageSupplier: Organization: Debian", "PackageDownloadLocation: NOASSERTION", "FilesAnalyzed: false",
                  f"PackageLicenseConcluded: {licence}", f"PackageLicenseDeclared: {licence}", "PackageCopyrightText: NOASSERTION",
                  f"PackageComment: <text>text in licences/{name}; " + ("files: " + ", ".join(sorted(files)) if files else "compiled in") + "</text>",
                  f"Relationship: SPDXRef-straytrace CONTAINS {reference}"]
    place.write_text("\n".join(lines) + "\n", encoding="utf-8")


def licences(folder, version, epoch, files):
    """Texts and list; `files`: name and path of every library."""
    by_package = {}
    for name, path in files.items():
        by_package.setdefault(package_of(path), set()).add(name)
    listed = []
    texts = folder / "licences"
    texts.mkdir()
    for (package, its_version), names in sorted(by_package.items()):
        listed.append((package, its_version, LICENCES.get(package, "NOASSERTION"), names))
    for package, licence in sorted(BUILT_IN.items()):
        told = subprocess.run(["dpkg-query", "-W", "-f=${Version}", package], capture_output=True, text=True, check=False)
        if told.returncode == 0 and told.stdout:
            listed.append((package, told.stdout, licence, set()))
    for package, *_ in listed:
        shutil.copyfile(licence_file(package), texts / package)
    write_spdx(folder / "LICENCES.spdx", version, epoch, listed)


def main(starter, place, *programs):
    folder, epoch = pathlib.Path(place), int(os.environ["SOURCE_DATE_EPOCH"])
    root = pathlib.Path(__file__).resolve().parents[2]
    version = re.search(r"straytrace VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text()).group(1)
    for part in ("bin", "lib/programs"):
        (folder / part).mkdir(parents=True)
    for program in map(pathlib.Path, programs):
        subprocess.run(["strip", "-o", folder / "lib/programs" / program.name, program], check=True)
        shutil.copyfile(starter, folder / "bin" / program.name)
        (folder / "bin" / program.name).chmod(0o755)
    loader = pathlib.Path("/lib64", LOADER)
    shutil.copyfile(loader.resolve(), folder / "bin" / LOADER)
    (folder / "bin" / LOADER).chmod(0o755)
    files = libraries(programs)
    for name, path in files.items():
        subprocess.run(["strip", "--strip-unneeded", "-o", folder / "lib" / name, path.resolve()], check=True)
    licences(folder, version, epoch, {**files, LOADER: loader})
    sums = hashlib.sha256(b"".join(sorted(p.read_bytes() for p in folder.rglob("*") if p.is_file()))).hexdigest()
    print(f"bundle: {len(files)} libraries, {sum(p.stat().st_size for p in folder.rglob('*') if p.is_file()) / 1e6:.0f} MB, sha256 {sums[:16]}")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
