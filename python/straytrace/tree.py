# SPDX-License-Identifier: BSD-3-Clause
"""Tables and lists of a model as Python writes them: ``model.beams.arm.power = "650 kW"``."""

from __future__ import annotations

import difflib
import io
import math
import os
from collections.abc import Iterable, Iterator, Mapping, MutableMapping, MutableSequence
from typing import Any, overload

import numpy as np
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import YAMLError

__all__ = ["FORMAT", "SCALARS", "Items", "Table", "YAMLError", "dump", "load", "plain", "quantity", "scene_tree", "wrapped"]

FORMAT = 1                     # of the scene language
SCALARS = (str, bool, int, float)


def quantity(value: float, unit: str) -> str:
    """A number with its unit, as written in models: ``quantity(3, "km")`` is ``"3 km"``."""
    number = plain(value, "quantity")
    if isinstance(number, bool) or not isinstance(number, (int, float)):
        raise TypeError(f"quantity takes a number and a unit, not {value!r}; write quantity(3, 'km')")
    return f"{number!r} {unit}"


def _scalar(value: Any, where: str) -> Any:
    """A value of YAML, or None if it is not a scalar."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{where}: {value} is not a valid number of a model; remove the key, or write a finite value")
    if isinstance(value, SCALARS):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value).replace(os.sep, "/")
    for number, unit in (("magnitude", "units"), ("value", "unit")):      # pint, astropy
        if hasattr(value, number) and hasattr(value, unit):
            return quantity(getattr(value, number), str(getattr(value, unit)))
    return None


def plain(value: Any, where: str) -> Any:
    """`value` as YAML can hold it; TypeError with a hint for all else. `where` names the place in messages."""
    if isinstance(value, (Table, Items)):
        return value.data
    if (scalar := _scalar(value, where)) is not None:
        return scalar
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise TypeError(f"{where}: the key {key!r} is not text; write {str(key)!r}")
        return CommentedMap((key, plain(entry, f"{where}.{key}")) for key, entry in value.items())
    if isinstance(value, (list, tuple, np.ndarray)):
        entries = CommentedSeq(plain(entry, f"{where}[{i}]") for i, entry in enumerate(value))
        if all(isinstance(entry, SCALARS) for entry in entries):
            entries.fa.set_flow_style()
        return entries
    hint = "leave the key out" if value is None else "write a number, a text with a unit such as '3 km', a list or a dict"
    raise TypeError(f"{where}: {value!r} ({type(value).__name__}) cannot be in a model; {hint}")


def scene_tree(tables: Mapping[str, Any]) -> Any:
    """The tree of a scene file, which begins with its format."""
    tree = plain({**tables}, "model")
    tree.insert(0, "straytrace", tree.pop("straytrace", FORMAT))
    return tree


def wrapped(data: Any, where: str) -> Any:
    if isinstance(data, Mapping):
        return Table(data, where)
    return Items(data, where) if isinstance(data, list) else data


class Table(MutableMapping[str, Any]):
    """A table of a model: a dict whose keys are also attributes. Changes apply to the model."""

    data: Any
    where: str

    def __init__(self, data: Any, where: str) -> None:
        object.__setattr__(self, "data", data)
        object.__setattr__(self, "where", where)

    def __getitem__(self, key: str) -> Any:
        try:
            return wrapped(self.data[key], f"{self.where}.{key}")
        except KeyError:
            near = difflib.get_close_matches(str(key), [str(k) for k in self.data], 1)
            hint = f"did you mean '{near[0]}'?" if near else f"it has: {', '.join(self.data) or 'nothing'}"
            raise KeyError(f"{self.where} has no '{key}'; {hint}") from None

    def __setitem__(self, key: str, value: Any) -> None:
        if not isinstance(key, str):
            raise TypeError(f"{self.where}: the key {key!r} is not text; write {str(key)!r}")
        self.data[key] = plain(value, f"{self.where}.{key}")

    def __delitem__(self, key: str) -> None:
        self[key]
        del self.data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.data)

    def __len__(self) -> int:
        return len(self.data)

    def __getattr__(self, key: str) -> Any:
        if key.startswith("__"):
            raise AttributeError(key)
        try:
            return self[key]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __setattr__(self, key: str, value: Any) -> None:
        self[key] = value

    def __delattr__(self, key: str) -> None:
        del self[key]

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *self.data]

    def __repr__(self) -> str:
        return f"<{self.where}: {', '.join(self.data)}>"


class Items(MutableSequence[Any]):
    """A list of a model; a named entry can be accessed by its name: ``model.scene["baffle"]``."""

    def __init__(self, data: Any, where: str) -> None:
        self.data, self.where = data, where

    def _index(self, key: int | str) -> int:
        if isinstance(key, int):
            return key
        names = [entry.get("name") if isinstance(entry, Mapping) else None for entry in self.data]
        if key in names:
            return names.index(key)
        near = difflib.get_close_matches(str(key), [n for n in names if n], 1)
        hint = f"did you mean '{near[0]}'?" if near else f"it has: {', '.join(n for n in names if n)}"
        raise KeyError(f"{self.where} has no entry named '{key}'; {hint}")

    @overload
    def __getitem__(self, key: int | str) -> Any: ...
    @overload
    def __getitem__(self, key: slice) -> Any: ...
    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice):
            return [self[i] for i in range(*key.indices(len(self.data)))]
        return wrapped(self.data[self._index(key)], f"{self.where}[{key!r}]")

    def __setitem__(self, key: Any, value: Any) -> None:
        self.data[self._index(key)] = plain(value, f"{self.where}[{key!r}]")

    def __delitem__(self, key: Any) -> None:
        del self.data[self._index(key)]

    def __len__(self) -> int:
        return len(self.data)

    def insert(self, index: int, value: Any) -> None:
        """Puts `value` before entry number `index`."""
        self.data.insert(index, plain(value, f"{self.where}[{index}]"))

    def __repr__(self) -> str:
        return f"<{self.where}: {len(self.data)} entries>"


def _language() -> YAML:
    """YAML with its comments, kept from reading to writing."""
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
