"""Behaviour of all calls: threads, Ctrl-C, progress, warnings, memory."""

import os
import pickle
import resource
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import gladstone as gs


def test_threads_render_at_once(bos):
    setups = [bos.replace({"target.seed": seed}) for seed in (1, 2, 3, 4)]
    alone = [setup.render(device="cpu").images.copy() for setup in setups]
    together: dict[int, np.ndarray] = {}

    def work(number):
        together[number] = setups[number].render(device="cpu").images.copy()

    threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(together[number], alone[number]) for number in range(4))


def test_other_threads_run_meanwhile(bos):
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.wait(0.005):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.perf_counter()
    bos.replace({"render.rays_per_dot": 2000, "render.method": "rays"}).render(device="cpu")
    end = time.perf_counter()
    stop.set()
    thread.join()
    during = [t for t in ticks if start < t < end]
    assert len(during) >= min(5, (end - start) / 0.2)


LONG = """
import signal, sys, time
import gladstone as gs
signal.signal(signal.SIGINT, signal.default_int_handler)
setup = gs.Setup.from_dict({
    "camera": {"pixels": [512, 512], "pixel_pitch_um": 10.0},
    "lens": {"focal_length_mm": 105.0, "f_number": 11.0},
    "medium": {"field": {"kind": "gaussian_blob", "amplitude_kg_m3": -0.4, "radius_mm": 4.0}},
    "render": {"rays_per_dot": 200000, "method": "rays"},
})
print("ready", flush=True)
try:
    setup.render(device="cpu", progress=lambda label, done, total: label == "tracing rays" and print(label, flush=True))
except KeyboardInterrupt:
    print("interrupted", flush=True)
small = setup.replace({"camera.pixels": [64, 64], "render.rays_per_dot": 16, "correlate.window_px": [32]})
print(small.render(device="cpu").images.shape, flush=True)
"""


def test_ctrl_c_stops_within_a_second():
    child = subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    assert child.stdout.readline() == "tracing rays\n"
    start = time.perf_counter()
    os.kill(child.pid, signal.SIGINT)
    for line in child.stdout:
        if line == "interrupted\n":
            break
    seconds = time.perf_counter() - start
    rest = child.stdout.read()
    assert child.wait() == 0
    assert seconds < 1.0, seconds
    assert "(2, 64, 64)" in rest, "later calls work"


def test_progress_is_reported(bos):
    calls = []
    setup = bos.replace({"render.rays_per_dot": 3000, "render.method": "rays"})
    setup.render(device="cpu", progress=lambda *report: calls.append(report))
    assert calls and all(0 <= done <= total for _, done, total in calls)


def test_exception_in_progress_ends_the_call(bos):
    def fail(label, done, total):
        raise RuntimeError("enough")

    setup = bos.replace({"render.rays_per_dot": 5000, "render.method": "rays"})
    with pytest.raises(RuntimeError, match="enough"):
        setup.render(device="cpu", progress=fail)
    assert bos.render(device="cpu").images.any()


def test_warnings_name_the_caller(bos, codes):
    still = bos.replace({"medium.field": {"kind": "uniform_gradient", "gradient_kg_m4": [0.0, 0.0, 0.0]}})
    with pytest.warns(gs.GladstoneWarning) as caught:
        case = still.render(device="cpu")
    assert {str(warning.message) for warning in caught} & set(case.summary["warnings"])
    assert "unsuitable at medium.field" in codes(caught)
    assert pickle.loads(pickle.dumps(caught[0].message)).code == caught[0].message.code
    assert all(warning.filename == __file__ for warning in caught)


def test_nothing_is_printed(tmp_path):
    code = textwrap.dedent(
        """
        import gladstone as gs
        gs.Setup.from_dict({"camera": {"pixels": [64, 64]}, "correlate": {"window_px": [32]}, "render":
                            {"rays_per_dot": 16}}).render(device="cpu")
        """
    )
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def resident_mb() -> float:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


# Every call frees what it allocates: the resident memory is level once the allocators' pools are filled. Arenas of
# parallel loops once lost 49 KB per iteration, 20 MB here; GLADSTONE_LEAK_RENDERS=10000 is the long run.
def test_many_small_renders_leak_nothing(bos):
    count = int(os.environ.get("GLADSTONE_LEAK_RENDERS", "400"))
    field = {"kind": "uniform_gradient", "gradient_kg_m4": [150.0, 75.0, 0.0]}
    small = bos.replace({"camera.pixels": [48, 48], "correlate.window_px": [16], "medium.field": field})
    small = small.replace({"render.rays_per_dot": 16, "render.method": "rays"})

    def work(seed):
        case = small.replace({"target.seed": seed}).render(device="cpu")
        case.correlate(device="cpu")
        with pytest.raises(gs.SetupError):
            small.replace({"lens.f_numbr": 1}).render()

    for seed in range(100):
        work(seed)
    memory = {0: resident_mb()}
    for seed in range(1, count + 1):
        work(seed)
        if seed in (count // 10, count):
            memory[seed] = resident_mb()
    print(", ".join(f"{mb:.1f} MB after {renders} renders" for renders, mb in memory.items()))
    assert memory[count] - memory[0] < 5


def test_number_of_threads_changes_no_bit(bos, case):
    before = gs.threads()
    try:
        gs.set_threads(1)
        assert np.array_equal(bos.render(device="cpu").images, case.images)
    finally:
        gs.set_threads(0)
    assert gs.threads() == before


def test_device_that_is_absent_is_an_error(bos):
    if "cuda" in gs.build()["backends"]:
        pytest.skip("this build has a CUDA backend")
    with pytest.raises(gs.DeviceError):
        bos.render(device="cuda")
