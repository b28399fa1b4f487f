"""Small setups, and the program whose results the package must reproduce bit by bit."""

import json
import os
import shutil
import subprocess
from contextlib import contextmanager

import pytest

import gladstone as gs

BOS = {
    "camera": {"pixels": [96, 96], "pixel_pitch_um": 10.0, "noise": {"full_well_e": 20000, "read_noise_e": 4.0}},
    "lens": {"focal_length_mm": 105.0, "f_number": 11.0},
    "geometry": {"z_a_mm": 750.0, "z_d_mm": 250.0},
    "medium": {"field": {"kind": "gaussian_blob", "amplitude_kg_m3": -0.4, "radius_mm": 4.0}},
    "target": {"dots_per_32px_window": 20.0, "dot_diameter_px": 3.0},
    "render": {"rays_per_dot": 32},
    "correlate": {"window_px": [32, 16], "overlap": 0.5},
}

PIV = {
    "experiment": "piv",
    "camera": {"pixels": [64, 64], "pixel_pitch_um": 10.0},
    "lens": {"focal_length_mm": 105.0, "f_number": 8.0},
    "geometry": {"z_a_mm": 500.0},
    "particles": {"per_pixel": 0.02, "volume_mm": [4.0, 4.0, 1.0], "index": [1.45, 0.0]},
    "laser": {"thickness_mm": 1.0, "height_mm": 10.0},
    "flow": {"kind": "uniform", "velocity_m_s": [5.0, 2.0, 0.0], "dt_us": 10.0},
    "render": {"rays_per_dot": 16},
    "correlate": {"window_px": [32]},
}


@pytest.fixture(scope="session")
def bos() -> gs.Setup:
    return gs.Setup.from_dict(BOS)


@pytest.fixture(scope="session")
def case(bos) -> gs.Case:
    return bos.render(device="cpu")


@pytest.fixture(scope="session")
def piv() -> gs.Setup:
    return gs.Setup.from_dict(PIV)


@pytest.fixture(scope="session")
def program():
    """Runs the program and returns the JSON that it prints."""
    path = os.environ.get("GLADSTONE_PROGRAM") or shutil.which("gladstone")
    if path is None:
        pytest.skip("the program gladstone is neither in PATH nor named by GLADSTONE_PROGRAM")

    def run(*words, codes=(0,)):
        done = subprocess.run([path, *map(str, words), "--json", "--quiet", "--device", "cpu"], capture_output=True)
        assert done.returncode in codes, done.stderr.decode()
        return json.loads(done.stdout)

    run.path = path
    return run


@pytest.fixture(scope="session")
def written_case(program, bos, tmp_path_factory):
    """CASE folder of the program for the small BOS setup, with vectors and errors."""
    folder = tmp_path_factory.mktemp("program")
    bos.save(folder / "setup.toml")
    place = folder / "case"
    program("render", folder / "setup.toml", "-o", place)
    program("correlate", place)
    program("compare", place, "--no-figures")
    return place


@pytest.fixture
def refused():
    """Expects an exception of gladstone by its "code at place", with the name of a file without its folders, and names
    or numbers that its text contains."""

    @contextmanager
    def expect(kind, error, *values):
        with pytest.raises(kind) as caught:
            yield caught
        assert f"{caught.value.code} at {os.path.basename(caught.value.place)}" == error
        for value in values:
            assert value in caught.value.text

    return expect


@pytest.fixture
def codes():
    """Returns warnings as "code at place", with the name of a file without its folders."""

    def list_codes(caught):
        messages = [warning.message for warning in caught]
        return [
            one.code + (f" at {os.path.basename(one.place)}" if one.place else "")
            for one in messages
            if isinstance(one, gs.GladstoneWarning)
        ]

    return list_codes
