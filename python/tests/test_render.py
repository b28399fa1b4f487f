import numpy as np
import pytest

import gladstone as gs

TRUTH = [
    "position_m", "position_px", "displacement_px", "error_px", "std_px", "flux", "rays", "rays_planned", "eq9_px",
    "eq9_cone_px",
]  # fmt: skip


def same(a, b):
    return np.array_equal(a, b, equal_nan=True)


def test_images_and_truth_equal_those_of_the_program(case, written_case):
    written = gs.Case.load(written_case)
    assert same(case.images, written.images)
    assert case.images.dtype == np.uint16 and case.images.shape == (2, 96, 96)
    for name in TRUTH:
        assert same(getattr(case.truth, name), getattr(written.truth, name)), name
    assert case.setup.resolved() == written.setup.resolved()


def test_summary_equals_that_of_the_program(case, written_case):
    mine, theirs = case.summary, gs.Case.load(written_case).summary
    for summary in (mine, theirs):
        summary.pop("seconds_render")
    assert mine == theirs


def test_saved_case_is_that_of_the_program(case, written_case, tmp_path):
    case.save(tmp_path / "case")
    for name in ("reference.tif", "flow.tif", "setup.toml"):
        assert (tmp_path / "case" / name).read_bytes() == (written_case / name).read_bytes(), name
    written = gs.Case.load(tmp_path / "case")
    assert same(written.truth.displacement_px, case.truth.displacement_px)


def test_piv_equals_that_of_the_program(piv, program, tmp_path):
    piv.save(tmp_path / "piv.toml")
    program("render", tmp_path / "piv.toml", "-o", tmp_path / "case")
    written, case = gs.Case.load(tmp_path / "case"), piv.render(device="cpu")
    assert case.is_piv and written.is_piv
    assert same(case.images, written.images)
    for name in ("position_m", "second_m", "diameter_m", "displacement_px", "flux", "rays", "rays_planned"):
        assert same(getattr(case.truth, name), getattr(written.truth, name)), name
    assert case.truth.eq9_px is None
    assert case.accuracy == pytest.approx(written.accuracy, nan_ok=True)


def test_several_cameras_are_named(bos):
    pose = {"position_mm": [0.0, 0.0, 750.0], "look_at_mm": [0.0, 0.0, 0.0]}
    camera = {"pixels": [32, 32], "pixel_pitch_um": 10.0, "pose": pose}
    tables = bos.to_dict()
    tables["camera"] = [{"name": "left", **camera}, {"name": "right", **camera}]
    tables["geometry"] = {"z_d_mm": 250.0}
    tables["correlate"]["window_px"] = [16]
    cases = gs.Setup.from_dict(tables).render(device="cpu")
    assert list(cases) == ["left", "right"]
    assert same(cases["left"].truth.displacement_px, cases["right"].truth.displacement_px)


def test_calibration_planes(tmp_path, program):
    setup = gs.Setup.from_dict(CALIBRATION)
    case = setup.render(device="cpu")
    assert case.images.shape == (2, 128, 128) and len(case.planes_m) == 2
    case.save(tmp_path / "case")
    setup.save(tmp_path / "setup.toml")
    program("render", tmp_path / "setup.toml", "-o", tmp_path / "theirs")
    for name in ("plane_000.tif", "plane_001.tif"):
        assert (tmp_path / "case" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes()


CALIBRATION = {
    "experiment": "calibration",
    "camera": {"pixels": [128, 128], "pixel_pitch_um": 10.0},
    "lens": {"focal_length_mm": 105.0, "f_number": 11.0},
    "geometry": {"z_a_mm": 600.0},
    "calibration": {"planes_mm": [-2.0, 2.0], "spacing_mm": 0.5, "dot_diameter_mm": 0.15, "extent_mm": [5.0, 5.0]},
    "render": {"rays_per_dot": 32},
}


def test_arrays_are_views_that_outlive_the_case(bos):
    case = bos.render(device="cpu")
    images, truth = case.images, case.truth.displacement_px
    before = images.sum()
    assert not images.flags.owndata and not images.flags.writeable and not truth.flags.writeable
    del case
    assert images.sum() == before


def test_accuracy_is_known(case):
    assert 0 < case.accuracy.rms_px < 0.01
    assert case.accuracy.largest_px >= case.accuracy.rms_px


# A uniform gradient displaces everything by the same amount; the flow at every pixel is that of the dots.
def test_flow_of_a_uniform_gradient_is_uniform(bos):
    field = {"kind": "uniform_gradient", "gradient_kg_m4": [150.0, 75.0, 0.0]}
    case = bos.replace({"medium.field": field}).render(device="cpu")
    middle = np.nanmean(case.truth.displacement_px, axis=0)
    for at in ("mid", "a"):
        flow = case.truth.flow(at, spacing_px=8)
        assert flow.shape == (12, 12, 2)
        assert np.allclose(flow, middle, atol=0.02)


# The flow at pixel p of frame a equals the flow at the mid-position p + d/2, so that both differ little.
def test_both_flows_agree(case):
    at_a, mid = case.truth.flow("a", spacing_px=4), case.truth.flow("mid", spacing_px=4)
    assert at_a.shape == mid.shape == (24, 24, 2)
    assert 0 < np.abs(at_a - mid).max() < 0.2
    with pytest.raises(ValueError):
        case.truth.flow("b")
