"""Batches of rendered image pairs for training, independent of any machine-learning framework."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Literal, NamedTuple

import numpy as np

from . import _core, _toml
from ._setup import Setup, as_setup

Changes = Mapping[str, Any]


class Batch(NamedTuple):
    """Image pairs and their displacement. The arrays support DLPack and are in the memory of the device that rendered
    them."""

    images: Any
    """[pairs, 2, rows, columns]: frames a and b."""
    flow: Any
    """float32 [pairs, 2, rows, columns] in px, at the pixels of frame a, u to the right and v downwards;
    [1, 2, rows, columns] if all pairs have the same setup."""


class RenderedBatches:
    """Batches of PIV pairs with ideal particle images and exact displacement at every pixel.

    Item k depends on k alone. Particles are seeded, moved, drawn and recorded on the device. Results of a GPU remain in
    the memory of the GPU: `torch.from_dlpack`, `cupy.from_dlpack` and `jax.dlpack.from_dlpack` accept them without a
    copy. Results of the CPU are NumPy arrays. During iteration, the models of the next batch are built in another
    thread.

    Example: another vortex in each pair

        def vary(k, random):
            return [{"flow.circulation_m2_s": random.uniform(0.01, 0.1)} for _ in range(64)]

        for images, flow in gs.RenderedBatches("piv.toml", 64, vary, length=1000):
            a, b = cupy.from_dlpack(images).swapaxes(0, 1)
    """

    def __init__(
        self,
        setup,
        batch: int = 64,
        vary: Callable[[int, np.random.Generator], Changes | Sequence[Changes]] | None = None,
        *,
        length: int | None = None,
        seed: int = 0,
        device: str = "auto",
        dtype: Literal["float32", "uint8", "uint16"] = "float32",
    ):
        """Describes batches of `batch` pairs each; they are rendered on access.

        setup: a `Setup`, a dictionary of tables, or a setup file of a PIV experiment with one camera and ideal particle
            images: particles.scattering = "gaussian", "lambert", or "mie" with one diameter.
        vary: function of the batch's index and a random generator that returns the keys to replace: a dictionary for
            all pairs, or a list of one dictionary per pair. The frame size must be the same for all pairs of a batch.
            Changing only numbers in [flow] is fastest, since only this table is then read again.
        length: number of batches; None: unlimited.
        seed: changes the particles, the noise and the random generator of all batches.
        device: "auto" (a GPU if there is one), "cpu" or "cuda".
        dtype: "float32" (grey level over full scale, 0 to 1), or grey levels as "uint8" (camera.bit_depth of at most 8)
            or "uint16".
        """
        if batch < 1:
            raise ValueError(f"batch = {batch} is not a number of pairs; give at least 1")
        self.setup: Setup = as_setup(setup)
        self.batch, self.vary, self.length = batch, vary, length
        self.seed, self.device, self.dtype = seed, device, dtype
        if dtype == "uint8" and self.setup["camera.bit_depth"] > 8:
            raise ValueError('dtype = "uint8" requires camera.bit_depth of at most 8; use "uint16" or "float32"')
        self._open_source()

    def _open_source(self) -> None:
        self._source = _core.PairSource(self.setup._core, self.device)
        self._shared: tuple[Any, Any] | None = None

    def __len__(self) -> int:
        if self.length is None:
            raise TypeError("the number of batches is unlimited; give length")
        return self.length

    def __iter__(self) -> Iterator[Batch]:
        with ThreadPoolExecutor(1) as ahead:

            def prepare(index: int):
                seeds, changes = self._draw(index)
                return seeds, ahead.submit(self._build, changes)

            indices = itertools.count() if self.length is None else range(self.length)
            following = prepare(0) if self.length != 0 else None
            for index in indices:
                seeds, models = following[0], following[1].result()
                if index + 1 != self.length:
                    following = prepare(index + 1)
                yield self._render(seeds, models)

    def __getitem__(self, index: int) -> Batch:
        """Renders batch `index`."""
        if index < 0 or (self.length is not None and index >= self.length):
            raise IndexError(index)
        seeds, changes = self._draw(index)
        return self._render(seeds, self._build(changes))

    def _draw(self, index: int) -> tuple[list[tuple[int, int]], list[list[str]] | None]:
        """Returns the seeds of the pairs, and the key assignments common to all pairs or of each pair; None if no keys
        are replaced."""
        random = np.random.default_rng([self.seed, index])
        seeds = [tuple(pair) for pair in random.integers(1, 2**31, (self.batch, 2)).tolist()]
        if self.vary is None:
            return seeds, None
        given = self.vary(index, random)
        pairs = [given] if isinstance(given, Mapping) else list(given)
        if not isinstance(given, Mapping) and len(pairs) != self.batch:
            raise ValueError(f"vary returned {len(pairs)} dictionaries for {self.batch} pairs; return one per pair")
        return seeds, [[f"{key}={_toml.value(value)}" for key, value in pair.items()] for pair in pairs]

    def _build(self, changes: list[list[str]] | None):
        """Returns the models of a batch; None if all batches share the same models."""
        return None if changes is None else self._source.models(changes)

    def _render(self, seeds: list[tuple[int, int]], models) -> Batch:
        if models is None:
            if self._shared is None:
                renderer = self._source.open(self._source.models([[]]))
                self._shared = renderer, renderer.displacement()
            renderer, flow = self._shared
        else:
            renderer = self._source.open(models)
            flow = renderer.displacement()
        return Batch(renderer.render(seeds, self.dtype), flow)

    def __getstate__(self):
        return {key: value for key, value in self.__dict__.items() if key not in ("_source", "_shared")}

    def __setstate__(self, state) -> None:
        self.__dict__.update(state)
        self._open_source()
