# SPDX-License-Identifier: BSD-3-Clause
"""Pictures. Functions draw what they are given; each module of a JSON file is a command of its own, and __main__ opens run files."""
