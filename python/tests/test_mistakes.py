"""Mistakes that new users make: each message says what to do instead."""

import numpy as np
import pytest

import gladstone as gs


def test_images_are_arrays(case):
    with pytest.raises(TypeError, match="read files first"):
        gs.correlate("a.tif", "b.tif")
    with pytest.raises(TypeError, match="b is None"):
        gs.correlate(case.a, None)
    colours = np.stack([case.a] * 3, axis=-1)
    with pytest.raises(ValueError, match="grey image"):
        gs.correlate(colours, colours)


def test_text_of_a_setup_is_no_file_name():
    with pytest.raises(ValueError, match="Setup.from_file"):
        gs.Setup("table1.toml")


def test_devices_have_names(bos, case):
    for call in (bos.render, lambda device: gs.correlate(case.a, case.b, device=device)):
        with pytest.raises(gs.DeviceError, match='"auto", "cpu" or "cuda"'):
            call(device="gpu")


def test_vectors_may_be_a_file_but_not_nothing(case, tmp_path):
    case.correlate(device="cpu").save(tmp_path / "vectors.h5")
    assert case.compare(tmp_path / "vectors.h5").rms_px == case.compare(case.correlate(device="cpu")).rms_px
    with pytest.raises(TypeError, match="None"):
        case.compare(None)


def test_estimators_have_names():
    with pytest.raises(TypeError, match="by name"):
        gs.benchmark(lambda a, b: gs.correlate(a, b, window=32))
