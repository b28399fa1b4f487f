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


def test_messages_name_the_arguments_of_the_function(case):
    with pytest.raises(gs.SetupError) as caught:
        gs.correlate(case.a, case.b, windw=32, overlap=3, mask={"knid": "none"})
    problems = {problem.key: problem for problem in caught.value.problems}
    assert {"windw", "overlap"} <= set(problems)
    assert problems["windw"].code == "unknown_key" and 'did you mean "window"?' in problems["windw"].text
    assert problems["overlap"].code == "out_of_range" and problems["overlap"].file is None
    assert "correlate." not in str(caught.value)
    with pytest.raises(gs.DataError, match="set window smaller"):
        case.correlate(window=128)


@pytest.mark.parametrize("call, key", [
    (lambda case: gs.mie(-1, 1.5), "x"),
    (lambda case: gs.mie(1, 1.5 - 1j), "m"),
    (lambda case: gs.reconstruct(case, reference="left", overlap=2), "overlap"),
    (lambda case: gs.tomography([case] * 3, reference="left", spacing_mm=-1), "spacing_mm"),
    (lambda case: gs.stereo(case, case, sheet_z_mm=float("nan")), "sheet_z_mm"),
])  # fmt: skip
def test_options_are_arguments(case, call, key):
    with pytest.raises((gs.DataError, gs.SetupError)) as caught:
        call(case)
    assert (caught.value.key, caught.value.file) == (key, None)
    assert str(caught.value).startswith(key) and "--" not in str(caught.value)


def test_figures_have_known_endings(bos, tmp_path):
    with pytest.raises(gs.OutputError, match=".svg"):
        gs.info.setup(bos, figure=tmp_path / "layout.tiff")
    with pytest.raises(ValueError, match="figure_format"):
        gs.design(bos, figures=tmp_path, figure_format="tiff")
