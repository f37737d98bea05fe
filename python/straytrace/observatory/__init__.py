# SPDX-License-Identifier: BSD-3-Clause
"""Data of the observatories: records and segments for the program, curves for gwpy."""
