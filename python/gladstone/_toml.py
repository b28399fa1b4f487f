"""Python values as TOML."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping, Sequence

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


def key(name: str) -> str:
    """Returns a key as TOML, quoted if necessary."""
    return name if _BARE.match(name) else json.dumps(name, ensure_ascii=False)


def value(given) -> str:
    """Returns a value as TOML on one line."""
    if hasattr(given, "tolist"):  # NumPy scalars and arrays
        given = given.tolist()
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, int):
        return str(given)
    if isinstance(given, float):
        if math.isnan(given):
            return "nan"
        if math.isinf(given):
            return "inf" if given > 0 else "-inf"
        return repr(given)
    if isinstance(given, os.PathLike):
        given = os.path.abspath(os.fspath(given))
    if isinstance(given, str):
        return json.dumps(given, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(given, Mapping):
        return "{ " + ", ".join(f"{key(str(k))} = {value(v)}" for k, v in given.items()) + " }"
    if isinstance(given, Sequence):
        return "[" + ", ".join(value(one) for one in given) + "]"
    raise TypeError(f"{given!r} cannot be a value of a setup: give a number, a string, a list or a dictionary")


def document(table: Mapping) -> str:
    """Returns a dictionary of dictionaries as a TOML document."""
    lines: list[str] = []

    def write(path: tuple[str, ...], content: Mapping) -> None:
        tables = {k: v for k, v in content.items() if isinstance(v, Mapping)}
        for name, given in content.items():
            if name not in tables:
                lines.append(f"{key(str(name))} = {value(given)}")
        for name, inner in tables.items():
            inner_path = (*path, key(str(name)))
            lines.append(f"\n[{'.'.join(inner_path)}]")
            write(inner_path, inner)

    write((), table)
    return "\n".join(lines).lstrip("\n") + "\n"
