import json
import pickle

import numpy as np
import pytest

import gladstone as gs


@pytest.fixture(scope="module")
def field(case):
    return case.correlate(device="cpu")


@pytest.fixture(scope="module")
def report(case, field):
    return case.compare(field, device="cpu")


def test_errors_equal_those_of_the_program(report, written_case):
    mine, theirs = dict(report.errors), json.loads((written_case / "errors.json").read_text())
    for errors in (mine, theirs):
        errors.pop("made_from", None)
    assert mine == theirs


def test_loaded_case_gives_the_same_errors(report, written_case):
    again = gs.Case.load(written_case)
    loaded = again.compare(gs.Field.load(written_case / "vectors.h5"), device="cpu")
    assert loaded.errors == report.errors


def test_budget_adds_up(report):
    total = sum(term["bias_u_px"] or 0 for term in report.budget.values())
    assert total == pytest.approx(report.errors["budget"]["total"]["bias_u_px"], abs=1e-9)
    assert report.budget["noise"]["rms_px"] > 0


def test_arrays_agree_with_the_measures(report):
    errors = report.error_px[report.mask]
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(report.rms_px, rel=1e-12)
    assert report.truth_px.shape == (*report.shape, 2)


def test_vectors_of_another_code(case, field):
    report = case.compare((field.x, field.y, field.u, field.v), device="cpu")
    assert report.budget["noise"]["rms_px"] is None, "unknown for foreign vectors"
    assert report.rms_px == pytest.approx(case.compare(field, device="cpu").rms_px, rel=0.2)


# An estimator that fails is scored, too: zero vectors have the rms of the truth.
def test_vectors_unlike_the_truth_are_scored(case, codes):
    flow = case.truth.flow(device="cpu")
    with pytest.warns(gs.GladstoneWarning) as caught:
        zero = case.compare(np.zeros_like(flow), device="cpu")
    assert any(one.startswith("implausible") for one in codes(caught))
    assert zero.rms_px == pytest.approx(np.sqrt(np.mean(zero.truth_px[zero.mask] ** 2)), rel=1e-12)
    noise = np.random.default_rng(1).normal(size=flow.shape)
    with pytest.warns(gs.GladstoneWarning) as caught:
        assert case.compare(noise, device="cpu").rms_px > 0.9
    assert any(one.startswith("implausible") for one in codes(caught))


def test_tables_of_vectors_are_compared(case, field):
    pandas = pytest.importorskip("pandas")
    columns = {name: getattr(field, name).ravel() for name in "xyuv"}
    expected = case.compare(tuple(columns.values()), device="cpu").rms_px
    assert case.compare(columns, device="cpu").rms_px == expected
    table = pandas.DataFrame({name + "_px": values for name, values in columns.items()})
    assert case.compare(table, device="cpu").rms_px == expected
    with pytest.raises(ValueError, match="x_px"):
        case.compare(table[["x_px"]])


def test_fields_and_loaded_cases_survive_pickle(case, field, tmp_path):
    again = pickle.loads(pickle.dumps(field))
    for name in ("x", "y", "u", "v", "sigma_u", "status", "peak_ratio", "correlation"):
        assert np.array_equal(getattr(again, name), getattr(field, name), equal_nan=True), name
    for name in ("settings", "warnings", "verdict", "verdict_code", "device", "seconds", "uncertainty_method"):
        assert getattr(again, name) == getattr(field, name), name
    assert case.compare(again, device="cpu").errors == case.compare(field, device="cpu").errors
    arrays = gs.Field(field.x, field.y, field.u, field.v)
    assert (pickle.loads(pickle.dumps(arrays)).u == arrays.u).all()
    with pytest.raises(TypeError, match="Case.load"):
        pickle.dumps(case)
    with pytest.raises(TypeError, match="Report"):
        pickle.dumps(case.compare(field, device="cpu"))
    case.save(tmp_path / "case")
    loaded = pickle.loads(pickle.dumps(gs.Case.load(tmp_path / "case")))
    assert np.array_equal(loaded.images, case.images)


def test_objects_describe_themselves(case, bos):
    assert repr(case.truth) == f"<gladstone.Truth of {len(case.truth)} sources>"
    assert repr(gs.Study(bos, {"lens.f_number": [8]})) == "<gladstone.Study of lens.f_number>"


def test_frames_of_another_case_are_noticed(case, field, bos, codes, refused):
    other = bos.replace({"target.seed": 99}).render(device="cpu")
    with pytest.warns(gs.GladstoneWarning) as caught:
        other.compare(field, device="cpu")
    assert any(one.startswith("inconsistent") for one in codes(caught))
    with refused(gs.DataError, "inconsistent at field"):
        case.compare(gs.correlate(case.b, case.a, window=[32, 16], overlap=0.5, device="cpu"))


def test_report_is_drawn(report):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    figure = report.plot()
    assert len(figure.axes) >= 8
    budget = next(axis for axis in figure.axes if axis.get_title() == "error budget")
    assert len(budget.get_xticks()) <= 6  # their labels do not overlap
    assert "<table>" in report._repr_html_() and "Error budget" in str(report)


def test_images_and_vectors_are_drawn(case, field):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    images = [axis.images[0].get_array() for axis in case.plot().axes if axis.images]
    assert [np.array_equal(drawn, image) for drawn, image in zip(images, case.images)] == [True, True]
    maps = [axis.collections[0].get_array() for axis in field.plot().axes[:2]]
    for drawn, values in zip(maps, (field.u, field.v)):
        assert np.array_equal(drawn.filled(np.nan), np.where(field.valid, values, np.nan), equal_nan=True)
    arrows = field.plot().axes[0].collections[1]
    shown = len(arrows.U)
    assert 0 < shown <= np.sum(field.valid) and set(arrows.U) <= set(field.u[field.valid])
    assert len(gs.Field(*np.zeros((4, 0))).plot().axes[0].collections[1].U) == 0
    scattered = gs.Field(*(values.ravel()[1:] for values in (field.x, field.y, field.u, field.v)))
    assert len(scattered.plot().axes[0].collections[0].get_offsets()) == len(field) - 1


def test_html_report(report, tmp_path):
    findings = report.to_html(tmp_path / "report.html", device="cpu")
    assert findings and (tmp_path / "report.html").read_text().startswith("<!")
