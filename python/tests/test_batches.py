"""Batches for training. Tests on the CPU; those on a GPU also run where there is one."""

import pickle

import numpy as np
import pytest

import gladstone as gs


@pytest.fixture(scope="module")
def ideal(piv) -> gs.Setup:
    """Vortex seen with ideal particle images and noise."""
    tables = piv.to_dict()
    tables["camera"] |= {"pixels": [64, 48], "noise": {"full_well_e": 20000, "read_noise_e": 4.0}}
    tables["particles"]["scattering"] = "gaussian"
    tables["flow"] = {"kind": "lamb_oseen", "circulation_m2_s": 0.05, "core_radius_mm": 1.0, "dt_us": 10.0}
    tables["render"] = {}
    return gs.Setup.from_dict(tables)


def by_strength(strengths):
    return lambda k, random: [{"flow.circulation_m2_s": one} for one in strengths]


# The particles of a batch differ from those of a scene by rounding, 1e-13 of their light and position. A grey level
# differs only if it is that close to the edge of a level, which has a probability of 1e-9 per pixel. The displacement is
# a single-precision number of up to 10 px, whose rounding is 5e-7 px; both are found to 1e-9 px.
def test_pairs_are_those_of_their_setups(ideal):
    strengths = [0.02, 0.05, 0.09]
    batches = gs.RenderedBatches(ideal, 3, by_strength(strengths), dtype="uint16", device="cpu")
    images, flow = batches[4]
    assert images.shape == flow.shape == (3, 2, 48, 64) and images.dtype == np.uint16 and flow.dtype == np.float32
    seeds = np.random.default_rng([0, 4]).integers(1, 2**31, (3, 2))
    for pair, (strength, (particles, noise)) in enumerate(zip(strengths, seeds.tolist())):
        keys = {"particles.seed": particles, "camera.noise.seed": noise, "flow.circulation_m2_s": strength}
        case = ideal.replace(keys).render(device="cpu")
        assert np.array_equal(images[pair], case.images)
        assert np.abs(np.moveaxis(flow[pair], 0, -1) - case.truth.flow("a", device="cpu")).max() < 2e-6
    assert np.abs(flow[0] - flow[2]).max() > 0.1


def test_iteration_gives_the_batches_of_their_index_on_any_number_of_threads(ideal):
    def vary(k, random):
        return {"flow.circulation_m2_s": random.uniform(0.01, 0.1)}

    batches = gs.RenderedBatches(ideal, 2, vary, length=3, device="cpu")
    before = gs.threads()
    try:
        gs.set_threads(1)
        alone = [batches[k] for k in range(3)]
        gs.set_threads(3)
        iterated = list(batches)
    finally:
        gs.set_threads(before)
    assert len(batches) == len(iterated) == 3
    for one, other in zip(alone, iterated):
        assert np.array_equal(one.images, other.images) and np.array_equal(one.flow, other.flow)
        assert one.flow.shape == (1, 2, 48, 64)
    assert not np.array_equal(alone[0].flow, alone[1].flow)
    assert not np.array_equal(alone[0].images[0], alone[0].images[1])
    with pytest.raises(IndexError):
        batches[3]


# Numbers of [flow] are replaced by reading this table alone: the result is that of a complete setup, and so is the
# error of a wrong value. A key that the kind of flow does not have, and keys of other tables, require a complete reading.
def test_changes_are_checked_like_a_setup(ideal):
    def one(keys):
        return gs.RenderedBatches(ideal, 1, lambda k, random: keys, device="cpu", seed=7)[0]

    complete = gs.RenderedBatches(ideal.replace({"flow.circulation_m2_s": 0.08}), 1, device="cpu", seed=7)[0]
    assert np.array_equal(one({"flow.circulation_m2_s": 0.08}).images, complete.images)
    assert np.array_equal(one({"flow.circulation_m2_s": 0.08, "particles.per_pixel": 0.02}).images, complete.images)
    assert not np.array_equal(one({"particles.per_pixel": 0.01}).images, one({"particles.per_pixel": 0.02}).images)
    for keys, key in [
        ({"flow.dt_us": -1.0}, "flow.dt_us"),
        ({"flow.rate_1_s": 10.0}, "flow.rate_1_s"),
        ({"flow.circulation_m2_s": "strong"}, "flow.circulation_m2_s"),
    ]:
        with pytest.raises(gs.SetupError) as raised:
            one(keys)
        assert raised.value.key == key


def test_levels_have_the_type_that_was_requested(ideal):
    shares = gs.RenderedBatches(ideal, 2, device="cpu")[0].images
    levels = gs.RenderedBatches(ideal, 2, device="cpu", dtype="uint16")[0].images
    full_scale = np.float64(2 ** ideal["camera.bit_depth"] - 1)
    assert shares.dtype == np.float32 and np.array_equal(shares, (levels / full_scale).astype(np.float32))
    coarse = gs.RenderedBatches(ideal.replace({"camera.bit_depth": 8}), 2, device="cpu", dtype="uint8")[0].images
    assert coarse.dtype == np.uint8 and coarse.max() > 100


def test_mistakes_are_reported(ideal, piv):
    with pytest.raises(gs.DataError) as raised:
        gs.RenderedBatches(piv, 2, device="cpu")
    assert raised.value.code == "unsupported"
    with pytest.raises(ValueError, match="2 dictionaries for 3 pairs"):
        gs.RenderedBatches(ideal, 3, by_strength([0.1, 0.2]), device="cpu")[0]
    sizes = lambda k, random: [{"camera.pixels": [size, 48]} for size in (64, 32)]  # noqa: E731
    with pytest.raises(gs.DataError) as raised:
        gs.RenderedBatches(ideal, 2, sizes, device="cpu")[0]
    assert raised.value.key == "camera.pixels"
    with pytest.raises(TypeError):
        len(gs.RenderedBatches(ideal, 2, device="cpu"))


def test_batches_can_be_pickled(ideal):
    batches = gs.RenderedBatches(ideal, 2, device="cpu")
    assert np.array_equal(pickle.loads(pickle.dumps(batches))[1].images, batches[1].images)


# Bits of the CPU, except for a level that is within rounding of its edge (see above).
def test_batches_of_a_gpu_stay_there(ideal):
    cupy = pytest.importorskip("cupy")
    try:
        batches = gs.RenderedBatches(ideal, 3, by_strength([0.02, 0.05, 0.09]), dtype="uint16", device="cuda")
    except gs.DeviceError as error:
        pytest.skip(str(error))
    images, flow = batches[0]
    kind_of_gpu = 2  # kDLCUDA
    assert images.__dlpack_device__() == flow.__dlpack_device__() == (kind_of_gpu, cupy.cuda.Device().id)
    expected = gs.RenderedBatches(ideal, 3, by_strength([0.02, 0.05, 0.09]), dtype="uint16", device="cpu")[0]
    assert np.array_equal(cupy.from_dlpack(images).get(), expected.images)
    assert np.allclose(cupy.from_dlpack(flow).get(), expected.flow, rtol=0, atol=2e-6)
