import pickle

import numpy as np
import pytest

import gladstone as gs


def test_replaced_values_are_read(bos):
    setup = bos.replace({"lens.f_number": 16, "camera.pixels": np.array([32, 48])})
    assert setup["lens.f_number"] == 16
    assert setup["camera.pixels"] == [32, 48]
    assert bos["lens.f_number"] == 11.0, "the setup itself is unchanged"


def test_defaults_are_written_out(bos):
    assert bos.resolved()["correlate"]["method"] == "scc"
    assert "method" not in bos.to_dict()["correlate"]


def test_setup_survives_toml_and_pickle(bos, tmp_path):
    setup = bos.replace({"lens.focus": "medium"})
    setup.save(tmp_path / "setup.toml")
    assert gs.Setup.from_file(tmp_path / "setup.toml").resolved() == setup.resolved()
    assert pickle.loads(pickle.dumps(setup)) == setup


def test_file_names_are_relative_to_the_setup(tmp_path):
    (tmp_path / "points.csv").write_text("x_mm,y_mm\n0,0\n1,1\n")
    (tmp_path / "setup.toml").write_text('[target]\nkind = "points"\nfile = "points.csv"\n')
    setup = gs.Setup.from_file(tmp_path / "setup.toml")
    assert setup["target.file"] == str(tmp_path / "points.csv")
    assert setup.to_dict()["target"]["file"] == str(tmp_path / "points.csv")


def test_all_problems_name_file_line_and_key(tmp_path):
    path = tmp_path / "setup.toml"
    path.write_text('[lens]\nf_numbr = 3\nfocal_length_mm = "a"\n\n[camera]\nbit_depth = 77\n')
    with pytest.raises(gs.SetupError) as caught:
        gs.Setup.from_file(path)
    problems = {problem.key: problem for problem in caught.value.problems}
    assert set(problems) == {"lens.f_numbr", "lens.focal_length_mm", "camera.bit_depth"}
    assert all(problem.file == str(path) for problem in problems.values())
    assert problems["lens.f_numbr"].line == 2
    assert problems["camera.bit_depth"].line == 6
    assert isinstance(caught.value, ValueError)


def test_replaced_key_is_named(bos):
    with pytest.raises(gs.SetupError) as caught:
        bos.replace({"lens.f_number": "wide"})
    (problem,) = caught.value.problems
    assert problem.key == "lens.f_number" and problem.file is None


def test_what_replace_can_add_is_checked_later(tmp_path):
    (tmp_path / "setup.toml").write_text('[target]\nkind = "points"\nfile = "points.csv"\n')
    setup = gs.Setup.from_file(tmp_path / "setup.toml").replace({"lens.f_number": 8})
    with pytest.raises(gs.SetupError) as caught:
        setup.check()
    (problem,) = caught.value.problems
    assert (problem.key, problem.code, problem.line) == ("target.file", "missing_file", 3)
    (tmp_path / "points.csv").write_text("x_mm,y_mm\n0,0\n1,1\n")
    assert setup.check() is setup


def test_text_that_is_no_toml_is_refused():
    with pytest.raises(gs.SetupError) as caught:
        gs.Setup("[lens\n", name="mine")
    (problem,) = caught.value.problems
    assert (problem.file, problem.line) == ("mine", 1)


def test_errors_survive_pickle(bos):
    with pytest.raises(gs.SetupError) as caught:
        bos.replace({"lens.f_numbr": 3})
    again = pickle.loads(pickle.dumps(caught.value))
    assert again.problems == caught.value.problems


def test_missing_file_is_named(tmp_path):
    with pytest.raises(gs.SetupError) as caught:
        gs.Setup.from_file(tmp_path / "none.toml")
    assert caught.value.problems[0].file == str(tmp_path / "none.toml")
