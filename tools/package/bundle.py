#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Copies programs with the shared libraries that they load, and what starts them, into a folder; lists their licences.

Usage: bundle.py STARTER FOLDER PROGRAM|LIBRARY...
       bundle.py --licences FOLDER          only of what is compiled in, for a package that takes the libraries of the system

FOLDER/bin gets STARTER under the name of each program, and the loader; FOLDER/lib the libraries, without symbols;
FOLDER/lib/system those of the C and C++ language, which a process that loads LIBRARY takes from its system; FOLDER/lib/programs the
programs; FOLDER/licences the texts, and LICENCES.spdx, which lists all in SPDX 2.3."""
import datetime
import functools
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys

# Compiled into the programs: package of Debian with its licence.
BUILT_IN = {"libeigen3-dev": "MPL-2.0", "libcli11-dev": "BSD-3-Clause", "nlohmann-json3-dev": "MIT", "libboost-dev": "BSL-1.0",
            "librandom123-dev": "BSD-3-Clause", "libmeshoptimizer-dev": "MIT", "node-d3": "BSD-3-Clause",
            "libjs-three": "MIT"}
# Licences of what the programs load, by their SPDX expression: packages of Debian.
LICENCES = {package: licence for licence, packages in {
    "MIT": "libfmt9 libyaml-cpp0.7 libbrotli1 libcom-err2 libdeflate0 libexpat1 libffi8 libgssapi-krb5-2 libk5crypto3 libkrb5-3"
        " libkrb5support0 liblcms2-2 libmeshoptimizer2d libnghttp2-14 libpsl5 libx11-6 libxau6 libxcb1 libxdmcp6",
    "BSD-2-Clause": "libaec0 libsz2 libjxr0 libopenjp2-7",
    "BSD-3-Clause": "libhdf5-103-1 libhdf5-cpp-103-1 libassimp5 libbsd0 libimath-3-1-29 libopenexr-3-1-30 libp11-kit0 libssh2-1"
        " libwebp7 libwebpmux3",
    "Apache-2.0": "libssl3 libdraco7 liblerc4 libtbb12 libtbbmalloc2",
    "Zlib": "zlib1g libminizip1",
    "LGPL-2.1-or-later": "libc6 libnlopt0 libgnutls30 librtmp1 libtasn1-6",
    "LGPL-2.0-or-later": "libkeyutils1",
    "LGPL-2.1-only WITH OCCT-exception-1.0": "libocct-data-exchange-7.6 libocct-foundation-7.6 libocct-modeling-algorithms-7.6"
        " libocct-modeling-data-7.6 libocct-ocaf-7.6 libocct-visualization-7.6",
    "LGPL-2.1-only OR CDDL-1.0": "libraw20",
    "LGPL-3.0-or-later OR GPL-2.0-or-later": "libgmp10 libhogweed6 libnettle8 libidn2-0 libunistring2",
    "GPL-3.0-or-later WITH GCC-exception-3.1": "libgcc-s1 libstdc++6 libgomp1",
    "GPL-2.0-or-later": "libjbig0",
    "GPL-2.0-only OR GPL-3.0-only OR FreeImage": "libfreeimage3",
    "FTL OR GPL-2.0-or-later": "libfreetype6",
    "BSD-3-Clause OR GPL-2.0-only": "libzstd1",
    "HPND-sell-variant": "libfontconfig1",
    "IJG AND BSD-3-Clause AND Zlib": "libjpeg62-turbo",
    "libpng-2.0": "libpng16-16",
    "libtiff": "libtiff6",
    "curl": "libcurl4",
    "OLDAP-2.8": "libldap-2.5-0",
}.items() for package in packages.split()}
LOADER = "ld-linux-x86-64.so.2"
SYSTEM = ("libc6", "libgcc-s1", "libstdc++6")      # packages whose libraries must be those of the process


def output(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def libraries(programs):
    """The files that the loader takes for them, by the name under which it looks for them."""
    found = {}
    for program in programs:
        for name, path in re.findall(r"^\s*(\S+) => (/\S+) \(", output("ldd", program), re.MULTILINE):
            found[name] = pathlib.Path(path)
    return found


@functools.cache
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
        if told.returncode != 0 or not told.stdout:
            sys.exit(f"bundle: {package} is not installed: what is compiled in cannot be listed (scripts/setup)")
        listed.append((package, told.stdout, licence, set()))
    unclassified = [package for package, _, licence, _ in listed if licence == "NOASSERTION"]
    if unclassified:
        print("bundle: warning: licences of " + ", ".join(unclassified) + " are not classified: read their texts", file=sys.stderr)
    for package, *_ in listed:
        shutil.copyfile(licence_file(package), texts / package)
    write_spdx(folder / "LICENCES.spdx", version, epoch, listed)


def main(starter, place, *programs):
    folder, epoch = pathlib.Path(place), int(os.environ["SOURCE_DATE_EPOCH"])
    root = pathlib.Path(__file__).resolve().parents[2]
    version = re.search(r"straytrace VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text()).group(1)
    if starter == "--licences":
        licences(folder, version, epoch, {})
        return
    for part in ("bin", "lib/programs", "lib/system"):
        (folder / part).mkdir(parents=True)
    for program in map(pathlib.Path, programs):
        if ".so" in program.name:
            subprocess.run(["strip", "--strip-unneeded", "-o", folder / "lib" / program.name, program.resolve()], check=True)
            continue
        subprocess.run(["strip", "-o", folder / "lib/programs" / program.name, program], check=True)
        shutil.copyfile(starter, folder / "bin" / program.name)
        (folder / "bin" / program.name).chmod(0o755)
    loader = pathlib.Path("/lib64", LOADER)
    shutil.copyfile(loader.resolve(), folder / "bin" / LOADER)
    (folder / "bin" / LOADER).chmod(0o755)
    files = libraries(programs)
    for name, path in files.items():
        place = folder / "lib/system" if package_of(path)[0] in SYSTEM else folder / "lib"
        subprocess.run(["strip", "--strip-unneeded", "-o", place / name, path.resolve()], check=True)
    licences(folder, version, epoch, {**files, LOADER: loader})
    sums = hashlib.sha256(b"".join(sorted(p.read_bytes() for p in folder.rglob("*") if p.is_file()))).hexdigest()
    print(f"bundle: {len(files)} libraries, {sum(p.stat().st_size for p in folder.rglob('*') if p.is_file()) / 1e6:.0f} MB, sha256 {sums[:16]}")


if __name__ == "__main__":
    if len(sys.argv) < (3 if "--licences" in sys.argv else 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
