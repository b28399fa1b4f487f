"""Design of set-ups by formulas, with verification by simulation."""

from __future__ import annotations

import json
import os
from typing import Any

from . import _core
from ._errors import check_choice, check_whole
from ._progress import Progress, reporting
from ._setup import as_setup


class Design:
    """Design sheet of a setup, and the recommended set-up; made by `design`."""

    def __init__(self, answer: dict[str, Any], text: str, feasible: bool):
        self.answer = answer
        """All results, as `gladstone design --json` prints them."""
        self.feasible = feasible
        """Whether a set-up meets the requirements; True without requirements."""
        self._text = text

    @property
    def sheet(self) -> dict[str, Any]:
        """Design sheet: magnification, field of view [mm], sensitivity [px per kg/m^4], light cone [mm], ..."""
        return self.answer["sheet"]

    @property
    def recommended(self) -> dict[str, Any] | None:
        """Values of the free keys of the recommended set-up; None without requirements or a solution."""
        return self.answer.get("recommended")

    def __getitem__(self, name: str) -> Any:
        return self.answer[name]

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<gladstone.Design {'feasible' if self.feasible else 'not feasible'}>"


def design(
    setup,
    *,
    verify: int | None = None,
    repeats: int | None = None,
    seed: int | None = None,
    apply: str | os.PathLike | None = None,
    figures: str | os.PathLike | None = None,
    figure_format: str = "png",
    device: str = "auto",
    progress: Progress = False,
) -> Design:
    """Computes the design sheet of a setup. With a table [requirements], also recommends a set-up that meets them.

    verify: number of best combinations that are verified by rendering and correlation; 0: formulas only.
    repeats: number of simulations of each verified combination.
    seed: seed of the random numbers of the simulations.
    apply: file (TOML) to which the recommended setup is written.
    figures: folder for figures of the layout, the design map and the Pareto front.
    """
    check_choice("figure_format", figure_format, ("png", "svg", "pdf"))
    for name, given, least, most in (("verify", verify, 0, 100), ("repeats", repeats, 2, 1000), ("seed", seed, 0,
    2**62)):
        if given is not None:
            check_whole(name, given, least, most)
    with reporting(progress) as report:
        answer, text, feasible = _core.design(
            as_setup(setup)._core,
            -1 if verify is None else verify,
            -1 if repeats is None else repeats,
            -1 if seed is None else seed,
            os.fspath(apply or ""),
            os.fspath(figures or ""),
            figure_format,
            device,
            report,
        )
    return Design(json.loads(answer), text, feasible)
