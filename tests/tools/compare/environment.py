# SPDX-License-Identifier: BSD-3-Clause
"""The Python environment of scripts/setup --test, in the build folder of the program under test."""
import importlib.util
import os
import sys


def require_finesse(program):
    """Starts the script again in that environment where FINESSE is not installed here; ends it where it is in neither."""
    environment = os.path.join(os.path.dirname(os.path.abspath(program)), "compare", "bin", "python")
    if importlib.util.find_spec("finesse"):
        return
    if os.path.exists(environment) and os.path.abspath(sys.executable) != environment:
        os.execv(environment, [environment] + sys.argv)
    sys.exit("FINESSE is not there: run scripts/setup --test")
