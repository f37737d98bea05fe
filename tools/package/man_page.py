#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The manual page of the program, from its help, on stdout. Usage: man_page.py PROGRAM VERSION"""
import subprocess
import sys


def escaped(text):
    return text.replace("\\", "\\e").replace("-", "\\-")


def main(program, version):
    lines = subprocess.run([program, "--help"], check=True, capture_output=True, text=True).stdout.splitlines()
    print(f'.TH STRAYTRACE 1 "" "straytrace {version}" "User Commands"')
    print(".SH NAME\nstraytrace \\- stray\\-light noise in gravitational\\-wave detectors\n.SH SYNOPSIS\n.B straytrace\nCOMMAND ...\n"
          ".SH DESCRIPTION\n.nf")
    for line in lines:
        print(("\\&" if line.startswith((".", "'")) else "") + escaped(line))
    print(".fi\n.SH SEE ALSO\nEach command has \\-\\-help with examples.")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
