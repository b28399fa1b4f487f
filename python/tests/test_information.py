import numpy as np
import pytest

import gladstone as gs


def test_mie_equals_that_of_the_program(program):
    theirs = program("info", "mie", "--x", "5.9", "--m", "1.45,0.01")
    mine = gs.mie(5.9, 1.45 + 0.01j)
    assert (mine.q_ext, mine.q_sca, mine.q_back, mine.g) == tuple(theirs[n] for n in ("q_ext", "q_sca", "q_back", "g"))
    assert [list(pair) for pair in zip(mine.angle_deg, mine.s11)] == theirs["s11"]


# S11 = (|S1|^2 + |S2|^2) / 2; the optical theorem relates extinction to the forward amplitude: q = 4/x^2 Re S(0).
def test_mie_amplitudes_obey_the_optical_theorem():
    sphere = gs.mie(12.0, 1.33 + 0.1j)
    s1, s2 = sphere.amplitudes(sphere.angle_deg)
    assert np.allclose((abs(s1) ** 2 + abs(s2) ** 2) / 2, sphere.s11, rtol=1e-12)
    assert 4 / 12.0**2 * s1[0].real == pytest.approx(sphere.q_ext, rel=1e-12)


def test_mie_refuses_what_is_no_sphere():
    with pytest.raises(gs.DataError):
        gs.mie(-1.0, 1.5)


def test_traced_rays_equal_those_of_the_program(bos, program, tmp_path):
    random = np.random.default_rng(1)
    start = np.column_stack([random.uniform(-2, 2, (20, 2)), np.full(20, -250.0)])
    direction = np.column_stack([random.normal(0, 0.005, (20, 2)), np.ones(20)])
    rays = gs.trace(bos, start, direction)
    bos.save(tmp_path / "setup.toml")
    table = "x_mm,y_mm,z_mm,dx,dy,dz\n"
    table += "".join(",".join(repr(float(n)) for n in [*p, *d]) + "\n" for p, d in zip(start, direction))
    (tmp_path / "rays.csv").write_text(table)
    program("trace", tmp_path / "setup.toml", "--rays", tmp_path / "rays.csv", "-o", tmp_path / "ends.csv")
    lines = [line.split(",") for line in (tmp_path / "ends.csv").read_text().splitlines()[1:]]
    assert list(rays.status) == [line[0] for line in lines]
    theirs = np.array([[float(n) for n in line[1:]] for line in lines])
    assert np.array_equal(rays.position_mm, theirs[:, 0:3], equal_nan=True)
    assert np.array_equal(rays.pixel, theirs[:, 7:9], equal_nan=True)
    assert "alive" in rays.status


def test_trace_names_the_ray(bos, refused):
    with refused(gs.DataError, "syntax at rays:1"):
        gs.trace(bos, [[0, 0, -250], [0, 0, -250]], [[0, 0, 1], [0, 0, 0]])


def test_image_in_memory_is_described_as_its_file(case, program, written_case):
    mine, theirs = gs.info.image(case.a), program("info", "image", written_case / "reference.tif")
    for name in ("columns", "rows", "minimum", "maximum", "mean", "dot_diameter_px", "noise", "snr"):
        assert mine[name] == theirs[name], name


def test_setup_is_described(bos, program, tmp_path):
    bos.save(tmp_path / "setup.toml")
    theirs = program("info", "setup", tmp_path / "setup.toml")
    mine = gs.info.setup(bos)
    assert mine["magnification"] == theirs["magnification"]
    assert mine["dots"] == theirs["dots"]
    assert mine["render"]["memory"] == theirs["render"]["memory"]


def test_particles_are_described(piv, program, tmp_path):
    piv.save(tmp_path / "piv.toml")
    theirs = program("info", "particles", tmp_path / "piv.toml")
    assert gs.info.particles(piv) == {name: theirs[name] for name in gs.info.particles(piv)}


def test_design_equals_that_of_the_program(bos, program, tmp_path):
    bos.save(tmp_path / "setup.toml")
    theirs = program("design", tmp_path / "setup.toml")
    design = gs.design(bos)
    assert design.sheet == theirs["sheet"] and design.feasible
    assert design.recommended is None


def test_calibration_equals_that_of_the_program(program, tmp_path):
    from test_render import CALIBRATION

    case = gs.Setup.from_dict(CALIBRATION).render(device="cpu")
    calibration = gs.calibrate(case)
    case.save(tmp_path / "case")
    theirs = program("calibrate", tmp_path / "case", "--no-figures")
    mine = calibration.results
    assert mine["pinhole"] == theirs["pinhole"]
    assert calibration.camera_matrix.shape == (3, 3)
    assert np.sqrt(np.mean(calibration.residual_px**2)) < 0.1
