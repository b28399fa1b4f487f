"""Delivery of the library's log: warnings become Python warnings, information goes to the logger "gladstone"."""

from __future__ import annotations

import logging
import os
import sys
import warnings

from ._errors import GladstoneWarning

_log = logging.getLogger("gladstone")
_folder = os.path.dirname(os.path.abspath(__file__)) + os.sep


def _caller():
    """Returns the innermost frame outside this package."""
    frame = sys._getframe(1)
    while frame.f_back and os.path.abspath(frame.f_code.co_filename).startswith(_folder):
        frame = frame.f_back
    return frame


def deliver(messages: list[tuple[bool, str]]) -> None:
    """Called by the compiled part at the end of each call."""
    for is_warning, text in messages:
        if not is_warning:
            _log.info(text)
            continue
        frame = _caller()
        registry = frame.f_globals.setdefault("__warningregistry__", {})
        warnings.warn_explicit(
            text, GladstoneWarning, frame.f_code.co_filename, frame.f_lineno, frame.f_globals.get("__name__"), registry
        )
