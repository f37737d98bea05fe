#!/usr/bin/env python3
"""Fail for a call by which a user's text could become a command or code, that reaches the network, or that reads a file
past the one function that refuses pipes and devices. Usage: check_calls.py [ROOT]"""
import pathlib
import re
import sys

# Pattern, reason, and the places where it is allowed.
CPP = (
    (r"::system\s*\(|\bpopen\s*\(", "starts a shell; use run_child of base/process/child_process.hpp", ()),
    (r"\bexec[lv][pe]{0,2}\s*\(|\bposix_spawnp?\s*\(|\bvfork\s*\(",
     "starts a program; use run_child of base/process/child_process.hpp", ("src/base/process/child_process.cpp",)),
    (r"\bfork\s*\(", "makes a process", ("src/session/scan/scan_points.cpp", "src/base/process/child_process.cpp")),
    (r"\b(?:socket|getaddrinfo|gethostbyname)\s*\(|\bcurl_|\bboost/(?:asio|beast)\b", "reaches the network; use LoopbackServer of io/loopback_server.hpp",
     ("src/io/loopback_server.cpp",)),
    (r"\bH5::H5File\b|\bH5Fopen", "opens HDF5, whose library breaks at some files; use hdf5::Reader",
     ("src/io/hdf5/contents.cpp", "src/io/hdf5/read_write.cpp", "src/io/hdf5/read_write.hpp")),
    (r"\b(?:own_contents|load_contents|slab_here)\s*\(",
     "reads HDF5 in this process, which a damaged file ends: only where the checksum of a run file was verified before; "
     "use hdf5::Reader",
     ("src/io/hdf5/contents.cpp", "src/io/hdf5/contents.hpp", "src/results/run_file/run_file.cpp")),
    (r"\bdlopen\s*\(", "loads code", ("src/session/backend.cpp", "src/base/process/child_process.cpp")),
    (r"\bregex_match\s*\(", "ends the program at a long text; use Pattern of base/text/pattern.hpp", ("src/base/text/pattern.cpp",)),
    (r"\bifstream\b|\bfopen\s*\(|\bfreopen\s*\(", "reads what may be a pipe or a device; use bytes_of_file",
     ("src/base/process/child_process.cpp",)),
)
PYTHON = (
    (r"\bos\.(?:system|popen)\b|\bshell\s*=\s*True", "starts a shell; give a list of words to subprocess", ()),
    (r"\bos\.exec\w*|\bos\.spawn\w*", "starts a program", ("python/straytrace/engine.py",)),
    (r"(?<![\w.])(?:eval|exec|__import__)\s*\(|\bpickle\b|\bmarshal\b|\byaml\.load\b|\ballow_pickle\s*=\s*True",
     "makes code of data", ()),
    (r"^\s*(?:import|from)\s+(?:socket|urllib|http|ftplib|smtplib|requests)\b", "reaches the network", ()),
)
FOLDERS = (("src", {".cpp", ".hpp"}, CPP), ("step", {".cpp", ".hpp"}, CPP), ("python", {".py"}, PYTHON))


def without_comment(line, suffix):
    return re.sub(r"#.*" if suffix == ".py" else r"//.*", "", line)


def problems_of(name, text, rules):
    for number, line in enumerate(text.split("\n"), 1):
        code = without_comment(line, pathlib.PurePath(name).suffix)
        for pattern, why, allowed in rules:
            if name not in allowed and (found := re.search(pattern, code)):
                yield f"{name}:{number}: '{found.group().strip()}' {why}"


def main(root):
    files = [(path, rules) for folder, endings, rules in FOLDERS for path in sorted((root / folder).rglob("*"))
             if path.suffix in endings]
    if not files:
        print(f"{root}: no source files found; is the path right?")
        return 1
    found = [p for path, rules in files for p in problems_of(path.relative_to(root).as_posix(), path.read_text(), rules)]
    print("\n".join(found) or f"{len(files)} source files call nothing they should not")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()))
