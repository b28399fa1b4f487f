import csv

import numpy as np

import gladstone as gs

AXES = {"lens.f_number": [8.0, 16.0], "target.seed": [1, 2]}


def test_table_equals_that_of_the_program(bos, program, tmp_path):
    run = gs.Study(bos, AXES).run(tmp_path / "mine", device="cpu")
    assert run.state["done"] == 4
    bos.save(tmp_path / "base.toml")
    (tmp_path / "study.toml").write_text(
        'base = "base.toml"\n[axes]\n"lens.f_number" = [8.0, 16.0]\n"target.seed" = [1, 2]\n'
    )
    program("sweep", "plan", tmp_path / "study.toml", "-o", tmp_path / "theirs")
    program("sweep", "run", tmp_path / "theirs")
    program("sweep", "collect", tmp_path / "theirs", "--no-figures")
    with open(tmp_path / "theirs" / "study.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    table = run.table
    assert set(table) == set(rows[0])
    for name, values in table.items():
        if name.startswith("seconds_") or values.dtype.kind in "US":
            continue
        theirs = np.array([float(row[name] or "nan") for row in rows])
        assert np.array_equal(values, theirs, equal_nan=True), name
    assert list(table["lens.f_number"]) == [8, 8, 16, 16]


def test_study_goes_on_where_it_was(bos, tmp_path):
    study = gs.Study(bos, {"target.seed": [1, 2]})
    study.plan(tmp_path / "run", device="cpu")
    assert gs.StudyRun(tmp_path / "run").state["missing"] == 2
    calls = []
    run = study.run(tmp_path / "run", device="cpu", progress=lambda label, done, total: calls.append((label, done, total)))
    assert run.state["done"] == 2
    assert calls[-1] == ("cases", 2, 2)


def test_images_are_packed(bos, tmp_path):
    run = gs.Study(bos, {"target.seed": [1, 2]}).run(tmp_path / "run", device="cpu", keep_images=True)
    assert run.pack(tmp_path / "set.h5", device="cpu") == 2
    assert (tmp_path / "set.h5").stat().st_size > 0
