"""Mistakes that new users make: each message says what to do instead."""

import pathlib

import numpy as np
import pytest

import gladstone as gs


def test_images_are_arrays(case):
    with pytest.raises(TypeError, match="a is 'a.tif'.*tifffile.imread"):
        gs.correlate("a.tif", "b.tif")
    with pytest.raises(TypeError, match="b is None"):
        gs.correlate(case.a, None)
    colours = np.stack([case.a] * 3, axis=-1)
    with pytest.raises(ValueError, match=r"^a .*\(96, 96, 3\)"):
        gs.correlate(colours, colours)


@pytest.mark.parametrize("image", [np.zeros((8, 8), object), np.zeros((8, 8), complex), np.zeros((8, 8), "m8[s]")])
def test_pixels_are_numbers(case, image, refused):
    with refused(gs.DataError, "wrong_type at a", "ndarray", str(image.dtype)):
        gs.correlate(image, image)
    with refused(gs.DataError, "wrong_type at a", "Case"):
        gs.correlate(case, case)


def test_masks_have_the_size_of_the_images(case):
    with pytest.raises(ValueError, match=r"^mask .*\(3, 4\)"):
        gs.correlate(case.a, case.b, mask=np.zeros((3, 4), bool))


def test_files_are_not_arrays(case):
    for call in (gs.correlate_ensemble, gs.correlate_sequence):
        with pytest.raises(TypeError, match="ndarray"):
            call([case.a, case.b])


def test_setups_are_text(bos):
    with pytest.raises(TypeError, match="Setup.from_dict"):
        gs.Setup(bos.to_dict())
    with pytest.raises(TypeError, match="Setup.from_file"):
        gs.Setup(pathlib.Path("table1.toml"))
    with pytest.raises(ValueError, match=r"gladstone.Setup\(text\)"):
        gs.trace(gs.init("bos"), [0, 0, 0], [0, 0, 1])


# What a function writes into a temporary folder is not named: it no longer exists when the user reads the message.
def test_temporary_files_are_not_named(bos, tmp_path):
    with pytest.raises(gs.SetupError) as caught:
        gs.Study(bos, {"lens.f_number": [8]}, repeats=0).plan(tmp_path / "run")
    assert (caught.value.file, caught.value.line, caught.value.key) == (None, None, "study.repeats")
    with pytest.raises(gs.DataError) as caught:
        gs.calibrate(bos, ["plane.tif"])
    assert caught.value.file == "setup.toml" and "/" not in str(caught.value).split(":")[0]
    with pytest.raises(gs.SetupError) as caught:
        gs.render_sequence(bos, tmp_path / "sequence")
    assert (caught.value.file, caught.value.code, caught.value.key) == (None, "missing_key", "sequence")


def test_a_setup_has_no_images(bos):
    with pytest.raises(ValueError, match="images"):
        gs.calibrate(bos)


def test_reports_have_known_endings(case, tmp_path, refused):
    for call in (lambda path: gs.report(tmp_path, path), case.compare(case.correlate(device="cpu")).to_html):
        with refused(gs.OutputError, "output at report.xyz", ".html", ".md"):
            call(tmp_path / "report.xyz")


def test_places_that_are_none_are_data_errors(refused):
    with refused(gs.DataError, 'unreadable_file at ""'):
        gs.Case.load("")


def test_names_of_estimators_are_not_ours():
    with pytest.raises(ValueError, match='"default"'):
        gs.benchmark({"default": gs.correlate}, cases=["vortex"])


def test_errors_of_devices_have_a_text(bos):
    with pytest.raises(gs.DeviceError) as caught:
        bos.render(device="gpu")
    assert caught.value.text == str(caught.value) and caught.value.key is None


def test_text_of_a_setup_is_no_file_name():
    with pytest.raises(ValueError, match="Setup.from_file"):
        gs.Setup("table1.toml")


def test_devices_have_names(bos, case):
    for call in (bos.render, lambda device: gs.correlate(case.a, case.b, device=device)):
        with pytest.raises(gs.DeviceError, match='"gpu".*"auto", "cpu" or "cuda"'):
            call(device="gpu")


def test_vectors_may_be_a_file_but_not_nothing(case, tmp_path):
    case.correlate(device="cpu").save(tmp_path / "vectors.h5")
    assert case.compare(tmp_path / "vectors.h5").rms_px == case.compare(case.correlate(device="cpu")).rms_px
    with pytest.raises(TypeError, match="None"):
        case.compare(None)


def test_estimators_have_names():
    with pytest.raises(TypeError, match="estimators"):
        gs.benchmark(lambda a, b: gs.correlate(a, b, window=32))


def test_messages_name_the_arguments_of_the_function(case, refused):
    with pytest.raises(gs.SetupError) as caught:
        gs.correlate(case.a, case.b, windw=32, overlap=3, mask={"knid": "none"})
    problems = {problem.key: problem for problem in caught.value.problems}
    assert {"windw", "overlap"} <= set(problems)
    assert problems["windw"].code == "unknown_key" and '"window"' in problems["windw"].text
    assert problems["overlap"].code == "out_of_range" and problems["overlap"].file is None
    assert "correlate." not in str(caught.value)
    with refused(gs.DataError, "wrong_shape at a", "128 px", "window"):
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


def test_figures_have_known_endings(bos, tmp_path, refused):
    with refused(gs.OutputError, "output at layout.tiff", ".svg"):
        gs.info.setup(bos, figure=tmp_path / "layout.tiff")
    with pytest.raises(ValueError, match="figure_format"):
        gs.design(bos, figures=tmp_path, figure_format="tiff")


# The limits are those of the command line. Without them the calls end the interpreter, write files without end, or
# compute something else.
@pytest.mark.parametrize("call, name", [
    (lambda case, folder: case.truth.flow(spacing_px=0), "spacing_px"),
    (lambda case, folder: case.truth.flow(spacing_px=10_001), "spacing_px"),
    (lambda case, folder: case.truth.flow(spacing_px=1.5), "spacing_px"),
    (lambda case, folder: case.truth.save(folder / "truth.nc", spacing_px=-3), "spacing_px"),
    (lambda case, folder: gs.convert(folder / "truth.h5", folder / "truth.nc", spacing_px=-1), "spacing_px"),
    (lambda case, folder: gs.convert(folder / "a.txt", folder / "a.nc", image_rows=-1), "image_rows"),
    (lambda case, folder: gs.Field.load(folder / "a.txt", image_rows=-5), "image_rows"),
    (lambda case, folder: gs.views(folder, across=0), "across"),
    (lambda case, folder: gs.tomography_setups(case.setup, folder, views=2), "views"),
    (lambda case, folder: gs.tomography_setups(case.setup, folder, views=17), "views"),
    (lambda case, folder: gs.info.image(case.a, bit_depth=-3), "bit_depth"),
    (lambda case, folder: gs.info.image(case.a, bit_depth=99), "bit_depth"),
    (lambda case, folder: gs.reconstruct(case, reference="left", samples=-1), "samples"),
    (lambda case, folder: gs.design(case.setup, verify=-1), "verify"),
    (lambda case, folder: gs.set_threads(-3), "threads"),
])  # fmt: skip
def test_whole_numbers_have_limits(case, tmp_path, call, name):
    with pytest.raises(ValueError, match=f"^{name} "):
        call(case, tmp_path)


def test_a_sequence_has_images(tmp_path, refused):
    with refused(gs.DataError, "arguments at images"):
        gs.correlate_sequence([], output=tmp_path / "vectors")
