"""Data sets for PyTorch whose images are rendered on access. Requires torch."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
import torch

from . import _batches
from ._case import Case
from ._errors import GladstoneWarning
from ._setup import as_setup


class RenderedPairs(torch.utils.data.Dataset):
    """Image pairs with exact displacement at every pixel; each item is rendered when it is accessed.

    Item i is (images, flow): images [2, rows, columns], float32 from 0 to 1; flow [2, rows, columns], float32 in px,
    u to the right and v downwards. Item i depends on i alone, so that several workers and epochs yield equal items.

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
        """Describes a data set of `length` items.

        setup: a `Setup`, a dictionary of tables, or a setup file of a BOS or PIV experiment with one camera.
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
    """Batches of PIV pairs with ideal particle images and exact displacement at every pixel, as tensors.

    `gladstone.RenderedBatches` with another order of arguments. Item k is (images, flow), tensors on the device that
    rendered them: images [batch, 2, rows, columns], float32 from 0 to 1; flow [batch, 2, rows, columns], float32 in px,
    at the pixels of frame a, u to the right and v downwards. It depends on k alone.

    Example: another vortex in each pair

        def vary(k, random):
            return [{"flow.circulation_m2_s": random.uniform(0.01, 0.1)} for _ in range(64)]

        for images, flow in RenderedBatches("setup.toml", 1000, 64, vary):
            ...
    """

    def __init__(
        self,
        setup,
        length: int,
        batch_size: int,
        vary: Callable[[int, np.random.Generator], Mapping[str, Any] | Sequence[Mapping[str, Any]]] | None = None,
        *,
        seed: int = 0,
        device: str = "auto",
    ):
        """Describes `length` batches of `batch_size` pairs each; the other arguments are those of
        `gladstone.RenderedBatches`."""
        self.batches = _batches.RenderedBatches(setup, batch_size, vary, length=length, seed=seed, device=device)

    def __len__(self) -> int:
        return len(self.batches)

    def __iter__(self):
        return (self._tensors(batch) for batch in self.batches)

    def __getitem__(self, index: int) -> tuple[torch.Tensor, torch.Tensor]:
        """Renders batch `index`."""
        return self._tensors(self.batches[index])

    def _tensors(self, batch: _batches.Batch) -> tuple[torch.Tensor, torch.Tensor]:
        images, flow = (torch.from_dlpack(one) for one in batch)
        return images, flow.expand(len(images), -1, -1, -1)
