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


@pytest.mark.parametrize("device", ["cpu", "cuda"])
def test_batches_are_tensors_where_they_were_rendered(piv, device):
    from gladstone.torch import RenderedBatches

    if device == "cuda" and not torch.cuda.is_available():
        pytest.skip("requires a GPU")
    setup = piv.replace({"particles.scattering": "gaussian", "camera.pixels": [64, 48], "render.rays_per_dot": "auto"})
    batches = RenderedBatches(setup, 2, 3, device=device)
    images, flow = batches[0]
    assert images.device.type == flow.device.type == device
    assert images.shape == flow.shape == (3, 2, 48, 64)
    assert torch.equal(images, batches[0][0]) and not torch.equal(images, batches[1][0])
    assert len(batches) == len(list(batches)) == 2
    case = setup.render()
    truth = torch.from_numpy(case.truth.flow("a").copy()).movedim(-1, 0)
    assert torch.allclose(flow[0].cpu().double(), truth.double(), atol=1e-5)
