"""Delivery of the library's log: warnings become Python warnings, information goes to the logger "gladstone"."""

from __future__ import annotations

import logging
import warnings

from ._arguments import CalledFunction, calling_frames
from ._errors import GladstoneWarning

_log = logging.getLogger("gladstone")


def deliver(messages: list[tuple[bool, str]]) -> None:
    """Delivers the messages of a call of the compiled module, pairs (is_warning, text). The compiled module calls this
    function at the end of each call."""
    for is_warning, text in messages:
        if not is_warning:
            _log.info(text)
            continue
        frame = calling_frames()[-1]
        registry = frame.f_globals.setdefault("__warningregistry__", {})
        named = CalledFunction().message(text)
        module = frame.f_globals.get("__name__")
        warnings.warn_explicit(named, GladstoneWarning, frame.f_code.co_filename, frame.f_lineno, module, registry)
