import pytest

torch = pytest.importorskip("torch")


def test_items_depend_on_their_index_alone(bos):
    from gladstone.torch import RenderedPairs

    pairs = RenderedPairs(
        bos.replace({"camera.pixels": [32, 32], "correlate.window_px": [16]}),
        3,
        lambda i, random: {"medium.field.amplitude_kg_m3": float(random.uniform(-0.5, -0.1))},
    )
    images, flow = pairs[1]
    assert images.shape == flow.shape == (2, 32, 32)
    assert images.dtype == flow.dtype == torch.float32 and 0 <= images.min() and images.max() <= 1
    again, other = pairs[1][0], pairs[2][0]
    assert torch.equal(images, again) and not torch.equal(images, other)
    assert len(pairs) == 3
    with pytest.raises(IndexError):
        pairs[3]
