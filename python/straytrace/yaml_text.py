# SPDX-License-Identifier: BSD-3-Clause
"""YAML with its comments, kept from reading to writing."""

import io
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

__all__ = ["YAMLError", "dump", "load"]


def _language() -> YAML:
    yaml = YAML()
    yaml.preserve_quotes = True
    yaml.width = 4096
    yaml.indent(mapping=2, sequence=4, offset=2)
    yaml.representer.ignore_aliases = lambda *_: True      # a table used twice is written twice
    return yaml


def load(text: str) -> Any:
    """Tables, lists and scalars of a text; raises YAMLError."""
    return _language().load(text)


def dump(tree: Any) -> str:
    """The text of a tree."""
    out = io.StringIO()
    _language().dump(tree, out)
    return out.getvalue()
