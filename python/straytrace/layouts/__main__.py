# SPDX-License-Identifier: BSD-3-Clause
"""Turns a specular layout into a scene: python3 -m straytrace.layouts"""

import sys

from . import main

sys.exit(main())
