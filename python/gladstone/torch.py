"""Data sets for PyTorch whose images are rendered on the fly. Needs torch."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np
import torch

from . import _core
from ._case import Case
from ._errors import GladstoneWarning
from ._setup import as_setup


class RenderedPairs(torch.utils.data.Dataset):
    """Image pairs with exact displacement at every pixel; each item is rendered when it is asked for.

    Item i is (images, flow): images [2, rows, columns], float32 from 0 to 1; flow [2, rows, columns], float32 in px,
    u to the right and v downwards. It depends on i alone, so that several workers and epochs give equal items.

    Example: random dots and a random density gradient for each item

        def vary(i, random):
            return {"medium.field.gradient_kg_m4": list(random.normal(0, 20, 3))}

        pairs = RenderedPairs("setup.toml", 10_000, vary)
        loader = torch.utils.data.DataLoader(pairs, batch_size=8, num_workers=4)
    """

    def __init__(
        self,
        setup,
        length: int,
        vary: Callable[[int, np.random.Generator], Mapping[str, Any]] | None = None,
        *,
        at: Literal["mid", "a"] = "a",
        seed: int = 0,
        device: str = "cpu",
    ):
        """Makes a data set of `length` items.

        setup: a `Setup`, a dictionary of tables, or a setup file, of BOS or PIV with one camera.
        vary: function of the index and a random generator that returns the keys to replace; the seeds of dots,
            particles and noise are replaced for every item.
        at: pixel to which the flow belongs: "a" (in frame a, as networks for optical flow are trained) or "mid".
        device: device that renders.
        """
        self.setup, self.length, self.vary = as_setup(setup), length, vary
        self.at, self.seed, self.device = at, seed, device
        tables = self.setup.to_dict()
        self._piv = tables.get("experiment") == "piv"
        self._noise = "noise" in tables.get("camera", {})

    def __len__(self) -> int:
        return self.length

    def case(self, index: int) -> Case:
        """Renders the case of an item."""
        if not 0 <= index < self.length:
            raise IndexError(index)
        random = np.random.default_rng([self.seed, index])
        source, noise = (int(one) for one in random.integers(1, 2**31, 2))
        replaced: dict[str, Any] = {"particles.seed" if self._piv else "target.seed": source}
        if self._noise:
            replaced["camera.noise.seed"] = noise
        if self.vary is not None:
            replaced.update(self.vary(index, random))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GladstoneWarning)
            return self.setup.replace(replaced).render(device=self.device)

    def __getitem__(self, index: int) -> tuple[torch.Tensor, torch.Tensor]:
        case = self.case(index)
        full_scale = 2 ** case.setup.to_dict()["camera"]["bit_depth"] - 1
        images = torch.from_numpy(case.images.astype(np.float32) / np.float32(full_scale))
        flow = case.truth.flow(self.at, device=self.device)
        return images, torch.from_numpy(np.ascontiguousarray(np.moveaxis(flow, -1, 0), dtype=np.float32))


class RenderedBatches(torch.utils.data.IterableDataset):
    """Batches of PIV pairs with ideal particle images and exact displacement at every pixel, rendered on the GPU.

    Item k is (images, flow), tensors on the GPU: images [batch, 2, rows, columns], float32 from 0 to 1; flow [batch, 2,
    rows, columns], float32 in px, at the pixels of frame a, u to the right and v downwards. It depends on k alone.
    Particles are seeded, moved, drawn and recorded on the GPU, so that thousands of pairs are rendered per second. The
    pairs of a batch have the same setup and hence the same flow, but other particles and other noise.

    Example: another vortex in each batch

        def vary(k, random):
            return {"flow.circulation_m2_s": float(random.uniform(0.01, 0.1))}

        for images, flow in RenderedBatches("setup.toml", 1000, 64, vary):
            ...
    """

    def __init__(
        self,
        setup,
        length: int,
        batch_size: int,
        vary: Callable[[int, np.random.Generator], Mapping[str, Any]] | None = None,
        *,
        seed: int = 0,
    ):
        """Makes `length` batches of `batch_size` pairs.

        setup: a `Setup`, a dictionary of tables, or a setup file, of PIV with one camera whose particles have ideal
            images; particles.scattering = "gaussian", "lambert", or "mie" with one diameter.
        vary: function of the batch's index and a random generator that returns the keys to replace.
        """
        self.setup, self.length, self.batch_size, self.vary, self.seed = as_setup(setup), length, batch_size, vary, seed
        self._shared = None

    def __len__(self) -> int:
        return self.length

    def __iter__(self):
        return (self[index] for index in range(self.length))

    def __getitem__(self, index: int) -> tuple[torch.Tensor, torch.Tensor]:
        """Renders batch `index`."""
        if not 0 <= index < self.length:
            raise IndexError(index)
        random = np.random.default_rng([self.seed, index])
        seeds = random.integers(1, 2**31, (self.batch_size, 2)).tolist()
        batches, flow = self._renderer(index, random)
        images = torch.from_dlpack(batches.render([tuple(pair) for pair in seeds], "float32"))
        return images, flow.expand(self.batch_size, -1, -1, -1)

    def _renderer(self, index: int, random: np.random.Generator):
        """Returns the renderer of a batch and its flow, which all batches share unless they vary."""
        if self.vary is not None:
            return self._open(self.setup.replace(self.vary(index, random)))
        if self._shared is None:
            self._shared = self._open(self.setup)
        return self._shared

    @staticmethod
    def _open(setup):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GladstoneWarning)
            batches = _core.PairBatches([setup._core])
        return batches, torch.from_dlpack(batches.displacement())
