import numpy as np

import gladstone as gs


def test_our_estimator_as_a_function_scores_as_itself():
    scores = gs.benchmark(
        {"again": lambda a, b: gs.correlate(a, b, device="cpu")}, cases=["vortex"], own=["default"], device="cpu"
    )
    ours, again = scores
    assert ours["estimator"] == "default" and again["estimator"] == "again"
    for name in set(ours) - {"estimator", "seconds"}:
        assert ours[name] == again[name] or (np.isnan(ours[name]) and np.isnan(again[name])), name
    first, second = str(scores).split("\n\n")
    assert f"{ours['rms_without_gross_px']:.5f}" in first and "vortex" in first
    assert f"{ours['rms_px']:.5f}" in second and "vortex" in second


# The truth itself, given at every pixel, has no error; given in frame a, it is moved to the middle.
def test_truth_scores_without_error():
    case = gs.BenchmarkCase("vortex", device="cpu")
    rows, columns = case.a.shape
    y, x = np.mgrid[0:rows:16, 0:columns:16].astype(float)
    truth = case.truth(x, y)
    scored = case.score((x, y, truth[..., 0], truth[..., 1]))
    assert scored["rms_px"] < 1e-12 and abs(scored["gain"] - 1) < 1e-12


def test_dense_flow_of_frame_a_is_moved_to_the_middle():
    def at_frame_a(a, b):
        case = gs.BenchmarkCase("vortex", device="cpu")
        y, x = np.mgrid[0 : a.shape[0], 0 : a.shape[1]].astype(float)
        flow = np.zeros((*a.shape, 2))
        for _ in range(30):
            flow = case.truth(x + flow[..., 0] / 2, y + flow[..., 1] / 2)
        return flow

    (moved,) = gs.benchmark({"exact": at_frame_a}, cases=["vortex"], own=[], at="a", device="cpu")
    assert moved["rms_px"] < 1e-6


def test_names_are_listed():
    assert "vortex" in gs.benchmark_cases() and "default" in gs.benchmark_estimators()
