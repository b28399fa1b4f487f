"""Setups: a description of an experiment that can be rendered."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from typing import Any

from . import _core, _toml
from ._progress import Progress, reporting


class Setup:
    """Setup of a BOS, PIV or calibration experiment; immutable.

    Keys and units are those of the setup file: lengths end in `_mm`, `_um` or `_px`, angles in `_deg`.
    Wrong keys and values raise a `SetupError` at once, which lists all of them. Missing required keys and files, which
    `replace` may still add, and values that contradict each other are reported by `check` and `render`.
    """

    def __init__(self, text: str = "", *, name: str = "setup", folder: str | os.PathLike | None = None):
        """Creates a setup from TOML text.

        name: shown in messages.
        folder: directory to which relative file names in the text refer; default: the working directory.
        """
        if not isinstance(text, str):
            source = "from_dict" if isinstance(text, Mapping) else "from_file"
            raise TypeError(f"expected TOML text, got {type(text).__name__}; use Setup.{source}")
        if "\n" not in text and text.endswith(".toml"):
            raise ValueError(f"{text!r} is the name of a file, not TOML text; use Setup.from_file")
        place = os.path.abspath(os.fspath(folder) if folder is not None else os.getcwd())
        self._core = _core.SetupText(text, name, place, [])

    @classmethod
    def _of(cls, core: _core.SetupText) -> Setup:
        setup = cls.__new__(cls)
        setup._core = core
        return setup

    @classmethod
    def from_file(cls, path: str | os.PathLike) -> Setup:
        """Reads a setup file (TOML)."""
        return cls._of(_core.SetupText.from_file(os.fspath(path)))

    @classmethod
    def from_dict(cls, tables: Mapping[str, Any], *, folder: str | os.PathLike | None = None) -> Setup:
        """Creates a setup from a dictionary of tables: `{"lens": {"f_number": 11}, ...}`."""
        return cls(_toml.document(tables), folder=folder)

    @property
    def _from_file(self) -> bool:
        """Whether the setup was read from a file, whose text is unchanged."""
        core = self._core
        try:
            with open(os.path.join(core.folder, os.path.basename(core.name)), encoding="utf-8") as file:
                return file.read() == core.text
        except (OSError, UnicodeDecodeError):
            return False

    def replace(self, values: Mapping[str, Any]) -> Setup:
        """Returns a setup with replaced values: `setup.replace({"lens.f_number": 16})`.

        Replace keys that depend on each other in one call, best as a table: `{"medium.field": {"kind": ...}}`. A given
        table replaces the whole table of the setup, so that keys that it does not contain have their defaults.
        """
        core = self._core
        given = [f"{path}={_toml.value(value)}" for path, value in values.items()]
        return self._of(_core.SetupText(core.text, core.name, core.folder, [*core.overrides, *given]))

    def check(self) -> Setup:
        """Checks the whole setup and the files to which it refers, and returns the setup. Raises `SetupError` with all
        problems."""
        self._core.resolved()
        return self

    def to_toml(self) -> str:
        """Returns the setup as TOML, without defaults."""
        return self._core.written()

    def to_dict(self) -> dict[str, Any]:
        """Returns the setup as a dictionary of tables, without defaults."""
        return tomllib.loads(self.to_toml())

    def resolved(self) -> dict[str, Any]:
        """Returns the setup with all defaults. For several cameras, returns a dictionary of setups by name of the
        camera."""
        texts = self._core.resolved()
        tables = {camera: tomllib.loads(text) for camera, text in texts.items()}
        return tables.get("", tables)  # the name of a single camera is empty

    def __getitem__(self, path: str) -> Any:
        """Returns the given or default value of a key: `setup["lens.f_number"]`."""
        value: Any = self.resolved()
        for part in path.split("."):
            if not isinstance(value, Mapping) or part not in value:
                raise KeyError(path)
            value = value[part]
        return value

    def save(self, path: str | os.PathLike) -> None:
        """Writes the setup as TOML, without defaults."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.to_toml())

    def render(self, *, device: str = "auto", progress: Progress = False) -> Any:
        """Traces the rays of the experiment.

        device: "auto" (a GPU if there is one), "cpu" or "cuda".
        progress: True: a progress bar; or a function (label, done, total).

        Returns a `Case` (BOS and PIV) or a `CalibrationCase`; for a setup with several cameras, a dictionary of cases
        by name of the camera. Annotate the result for type checkers: `case: gs.Case = setup.render()`. The images are
        equal bit by bit to those of `gladstone render`. Raises `SetupError`, `DataError`, `DeviceError`.
        """
        from ._calibration_case import CalibrationCase
        from ._case import Case

        with reporting(progress) as report:
            rendered = _core.render(self._core, device, report)
        cases = {one.camera: (Case if isinstance(one, _core.PairCase) else CalibrationCase)(one) for one in rendered}
        return cases.get("", cases)  # the name of a single camera is empty

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Setup) and self.__getstate__() == other.__getstate__()

    def __hash__(self) -> int:
        return hash(self.__getstate__())

    def __getstate__(self):
        core = self._core
        return core.text, core.name, core.folder, tuple(core.overrides)

    def __setstate__(self, state) -> None:
        text, name, folder, overrides = state
        self._core = _core.SetupText(text, name, folder, list(overrides))

    def __repr__(self) -> str:
        replaced = "".join(f", {one}" for one in self._core.overrides)
        return f"<gladstone.Setup {self._core.name}{replaced}>"


def render(setup: Setup | Mapping[str, Any] | str | os.PathLike, **options) -> Any:
    """Renders a setup, a dictionary of tables or a setup file; see `Setup.render`."""
    return as_setup(setup).render(**options)


def as_setup(given: Setup | Mapping[str, Any] | str | os.PathLike) -> Setup:
    """Returns a setup; a dictionary or a file is converted to a setup."""
    if isinstance(given, Setup):
        return given
    if isinstance(given, str) and "\n" in given:
        raise ValueError("expected a setup or the name of its file, got TOML text; use gladstone.Setup(text)")
    return Setup.from_dict(given) if isinstance(given, Mapping) else Setup.from_file(given)
