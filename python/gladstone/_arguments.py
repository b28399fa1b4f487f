"""Replaces command-line options and setup keys in messages by the arguments of the called Python function.

The library words its messages for the command line. Only names are replaced; nothing depends on the wording.
"""

from __future__ import annotations

import difflib
import json
import os
import re
import sys
from types import FrameType

_folder = os.path.dirname(os.path.abspath(__file__)) + os.sep
_TABLE = "correlate."  # functions with **settings take the keys of this table as arguments


def calling_frames() -> list[FrameType]:
    """Returns the frames from this package's innermost one to the user's code that called it."""
    frame = sys._getframe(1)
    frames = [frame]
    while frame.f_back and os.path.abspath(frame.f_code.co_filename).startswith(_folder):
        frame = frame.f_back
        frames.append(frame)
    return frames


class CalledFunction:
    """The function of this package that the user has called."""

    def __init__(self):
        inside = calling_frames()[:-1]
        self._code = inside[-1].f_code if inside else None

    @property
    def _arguments(self) -> tuple[str, ...]:
        code = self._code
        return code.co_varnames[: code.co_argcount + code.co_kwonlyargcount] if code else ()

    @property
    def _has_settings(self) -> bool:
        return self._code is not None and "settings" in self._code.co_varnames and bool(self._code.co_flags & 0x08)

    def option(self, name: str) -> str | None:
        """Returns the argument that corresponds to a command-line option, "--spacing" -> "spacing_mm"; None if there is
        none."""
        plain = name.removeprefix("--").replace("-", "_")
        return next((one for one in self._arguments if re.fullmatch(plain + "s?_?(mm|deg|px|nm)?", one)), None)

    def setting(self, key: str) -> str:
        """Returns the argument that corresponds to a setup key, "correlate.window_px" -> "window"; other keys are
        unchanged."""
        if not self._has_settings or not key.startswith(_TABLE):
            return key
        name = key.removeprefix(_TABLE)
        return "window" if name == "window_px" else name

    def message(self, text: str) -> str:
        """Returns a message in which arguments replace options and keys."""
        if self._has_settings:
            text = text.replace(_TABLE + "window_px", "window").replace(_TABLE, "")
        if "device" in self._arguments:
            text = re.sub(r"--device (\w+)", r'device="\1"', text)
        return re.sub(r"--[a-z]+(?:-[a-z]+)*", lambda match: self.option(match[0]) or match[0], text)

    def unknown_setting(self, name: str) -> str:
        """Returns the message about an argument that does not exist; it suggests the most similar argument."""
        from . import _core

        known = {one["key"].split(".")[1] for one in json.loads(_core.find_keys(_TABLE + "*"))["keys"]}
        known = sorted(known - {"window_px"} | {"window"} | {one for one in self._arguments if one != "self"})
        near = difflib.get_close_matches(name, known, n=1)
        hint = f'did you mean "{near[0]}"?' if near else "known are " + ", ".join(known)
        return f'{self._code.co_name}() has no argument "{name}"; {hint}'
