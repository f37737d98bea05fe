# SPDX-License-Identifier: BSD-3-Clause
"""Computes the power spectrum of a mirror map: python3 -m straytrace.maps"""

import sys

from . import main

sys.exit(main())
