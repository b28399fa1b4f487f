"""Delivery of the library's log: warnings become Python warnings, information goes to the logger "gladstone"."""

from __future__ import annotations

import logging
import warnings

from ._arguments import CalledFunction, calling_frames
from ._errors import GladstoneWarning, WarningText

_log = logging.getLogger("gladstone")


def deliver(messages: list[str]) -> None:
    """Delivers the messages of a call. The compiled module calls this function at the end of each call."""
    for message in messages:
        if not isinstance(message, WarningText):
            _log.info(message)
            continue
        frame = calling_frames()[-1]
        registry = frame.f_globals.setdefault("__warningregistry__", {})
        called = CalledFunction()
        place = called.option(message.place) if message.place.startswith("--") else called.setting(message.place)
        named = GladstoneWarning(WarningText(message.code, place or message.place, called.message(message.text)))
        module = frame.f_globals.get("__name__")
        warnings.warn_explicit(named, None, frame.f_code.co_filename, frame.f_lineno, module, registry)
