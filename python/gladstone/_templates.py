"""Templates of setups and studies, and the list of all keys."""

from __future__ import annotations

import json
import os
from typing import NamedTuple

from . import _core


class SetupKey(NamedTuple):
    """Key of a setup or a study."""

    key: str
    """Path of the key, such as "lens.f_number"."""
    condition: str
    """Key that the table must contain, such as `kind = "file"`; empty: none."""
    unit: str
    """Unit; "1": a pure number; empty: not a number."""
    default: str | None
    """Default as TOML; None: no default, or `default_words`."""
    default_words: str
    """Default in words, "required" or "none"; empty: see `default`."""
    required: bool
    """True if the key is required."""
    values: str
    """Allowed values, in words."""
    meaning: str
    """Meaning of the key."""
    kinds: list[str]
    """Kinds of `init` to which the table of the key applies."""


def init(kind: str, path: str | os.PathLike | None = None, *, all_keys: bool = False) -> str:
    """Returns a commented setup that runs as it is, equal to that of `gladstone init`.

    kind: "bos", "piv", "stereo", "calibration", "study" or "design".
    path: new file to which the text is also written; default: no file.
    all_keys: every key with its default, commented out, instead of the most important keys.

    Raises `DataError` for an unknown kind, and `OutputError` if the file exists.
    """
    if path is None:
        return _core.template_text(kind, all_keys)
    return _core.write_template(os.fspath(path), kind, all_keys)


def keys(pattern: str = "") -> list[SetupKey]:
    """Returns the keys of setups and studies that match a pattern, as `gladstone keys` prints them.

    pattern: part of a key's path ("f_number", "medium.field"), or a whole path with wildcards ("camera.*_um"); default:
        all keys.

    Raises KeyError, which lists similar keys, if no key matches.
    """
    found = json.loads(_core.find_keys(pattern))
    if not found["keys"]:
        similar = ", ".join(found["similar"])
        raise KeyError(f"no key matches {pattern!r}" + (f"; similar keys: {similar}" if similar else ""))
    return [SetupKey(**one) for one in found["keys"]]


def shared_folder() -> str:
    """Returns the folder of the package that contains shipped setups (`studies/cases`) and data (`data`), among them
    the experiment of Rajendran et al. (2019): `studies/cases/table1.toml`."""
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), "share", "gladstone")
