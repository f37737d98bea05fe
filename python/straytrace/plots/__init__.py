# SPDX-License-Identifier: BSD-3-Clause
"""Pictures. Functions draw their arguments; each module of a JSON file is a separate command, and __main__ opens run files."""
