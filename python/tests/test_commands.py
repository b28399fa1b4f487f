"""Functions for the commands that work on files and folders, against the program."""

import pickle
import subprocess

import numpy as np
import pytest

import gladstone as gs


def test_every_command_has_a_function(program):
    """Commands of `gladstone --help`; a command of another name or place is listed with its Python name."""
    elsewhere, program_only = {"sweep": "Study"}, {"completion"}
    listed = subprocess.run([program.path, "--help"], capture_output=True, text=True, check=True).stdout
    names = [line.split()[0] for line in listed.split("Subcommands:")[1].splitlines() if line.startswith("  ")]
    assert len(names) >= 18
    assert {name for name in names if not hasattr(gs, elsewhere.get(name, name))} <= program_only


@pytest.mark.parametrize("kind", ["bos", "piv", "stereo", "calibration", "study", "design"])
@pytest.mark.parametrize("all_keys", [False, True])
def test_templates_equal_those_of_the_program(program, kind, all_keys):
    assert gs.init(kind, all_keys=all_keys) == program("init", kind, *(["--all"] if all_keys else []))["text"]


def test_template_is_written_once(tmp_path, refused):
    path = tmp_path / "mine.toml"
    text = gs.init("bos", path)
    assert path.read_text() == text and "mine.toml" in text
    with refused(gs.OutputError, "output at mine.toml"):
        gs.init("bos", path)
    with refused(gs.DataError, "arguments at init", "boss"):
        gs.init("boss")


def test_shipped_setups_are_in_the_package():
    setup = gs.Setup.from_file(f"{gs.shared_folder()}/studies/cases/table1.toml").check()
    assert setup["lens.f_number"] == 11.0


def test_keys_equal_those_of_the_program(program):
    mine, theirs = gs.keys("f_number"), program("keys", "f_number")["keys"]
    assert [one._asdict() for one in mine] == theirs
    assert any(one.key == "lens.f_number" for one in mine)
    with pytest.raises(KeyError, match="f_number"):
        gs.keys("f_nmber")


def test_target_equals_that_of_the_program(bos, program, tmp_path):
    bos.save(tmp_path / "setup.toml")
    theirs = program("target", tmp_path / "setup.toml", "-o", tmp_path / "theirs.csv")
    mine = gs.target(bos, tmp_path / "mine.csv")
    assert (tmp_path / "mine.csv").read_bytes() == (tmp_path / "theirs.csv").read_bytes()
    assert mine["dots"] == theirs["dots"] == len((tmp_path / "mine.csv").read_text().splitlines()) - 1


# With a given exposure the pixels are those of the complete images, to within the scatter of the rays: a few levels of
# 65535 at some pixels. The dot pattern itself varies by thousands of levels.
def test_preview_is_a_part_of_the_images(bos):
    large = bos.replace({"camera.pixels": [256, 256], "camera.exposure": 20000.0, "render.rays_per_dot": 512})
    large = gs.Setup.from_dict({**large.to_dict(), "camera": {
        key: value for key, value in large.to_dict()["camera"].items() if key != "noise"}})
    preview, case = gs.preview(large, device="cpu"), large.render(device="cpu")
    column, row = preview.first_px
    _, rows, columns = preview.images.shape
    assert preview.images.dtype == np.uint16 and preview.at_gradient and preview.sources > 0
    part = case.images[:, row : row + rows, column : column + columns].astype(float)
    assert np.std(preview.images - part) < 0.02 * np.std(part)


def test_conversion_equals_that_of_the_program(written_case, program, tmp_path):
    theirs = program("convert", written_case / "vectors.h5", "-o", tmp_path / "theirs.csv")
    mine = gs.convert(written_case / "vectors.h5", tmp_path / "mine.csv")
    assert (tmp_path / "mine.csv").read_bytes() == (tmp_path / "theirs.csv").read_bytes()
    assert mine["valid"] == theirs["valid"] > 0
    truth = gs.convert(written_case / "truth.h5", tmp_path / "truth.csv")
    assert truth["format"] == "gladstone truth"


def test_report_of_a_case_folder(written_case, tmp_path):
    findings = gs.report(written_case, tmp_path / "report.md", device="cpu")
    assert findings and (tmp_path / "report.md").read_text().startswith("#")


def test_sequence_is_rendered_as_by_the_program(piv, program, tmp_path):
    flow = {key: value for key, value in piv.to_dict()["flow"].items() if key != "dt_us"}
    setup = gs.Setup.from_dict({**piv.to_dict(), "flow": flow, "sequence": {"frames": 3, "dt_us": 10.0}})
    setup.save(tmp_path / "sequence.toml")
    program("render", tmp_path / "sequence.toml", "-o", tmp_path / "theirs")
    summary = gs.render_sequence(setup, tmp_path / "mine", device="cpu")
    assert len(summary["pairs"]) == 2
    for name in ("frames/frame_0000.tif", "frames/frame_0002.tif", "pair_0001/flow.tif"):
        assert (tmp_path / "mine" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes(), name


def test_ensemble_equals_that_of_the_program(bos, program, tmp_path):
    images = []
    for seed in (1, 2):
        bos.replace({"target.seed": seed}).render(device="cpu").save(tmp_path / f"case{seed}")
        images += [tmp_path / f"case{seed}" / name for name in ("reference.tif", "flow.tif")]
    field = gs.correlate_ensemble(images, window=[32, 16], overlap=0.5)
    sets = ["--set", "correlate.window_px=[32,16]", "--set", "correlate.overlap=0.5"]
    program("correlate", "--ensemble", *images, "-o", tmp_path / "theirs.h5", *sets)
    theirs = gs.Field.load(tmp_path / "theirs.h5")
    assert np.array_equal(field.u, theirs.u, equal_nan=True) and np.array_equal(field.status, theirs.status)
    with pytest.raises(ValueError, match="3 images"):
        gs.correlate_ensemble(images[:3])


def test_oracles_equal_those_of_the_program(program):
    theirs = program("validate")["oracles"]
    mine = gs.validate(device="cpu")
    assert [(one.name, one.measured, one.passed) for one in mine] == [
        (one["name"], one["measured"], one["passed"]) for one in theirs
    ]
    assert all(one.passed for one in mine)


def test_views_need_a_plenoptic_camera(written_case, tmp_path, refused):
    with refused(gs.DataError, "unsupported at setup.toml", "[camera.lenslets]"):
        gs.views(written_case, tmp_path / "views")


def test_study_of_images_only(bos, tmp_path):
    run = gs.Study(bos, {"lens.f_number": [8, 16]}).plan(tmp_path / "run", device="cpu")
    run.compute(pairs_only=True, cases="1")
    assert run.state["done"] == 1
    assert (tmp_path / "run" / "cases" / "1" / "reference.tif").exists()
    run.compute()
    assert run.state["done"] == 2
    best = run.ranking[0]["points"]
    assert len(best) == 2 and best[0]["value"] <= best[1]["value"]


def test_errors_have_the_code_of_the_program(program, tmp_path):
    (tmp_path / "bad.toml").write_text("[lens]\nf_numbr = 3\n")
    theirs = program("render", tmp_path / "bad.toml", "-o", tmp_path / "case", codes=(2,))["errors"][0]
    with pytest.raises(gs.SetupError) as caught:
        gs.Setup.from_file(tmp_path / "bad.toml")
    mine = caught.value.problems[0]
    assert (mine.file, mine.line, mine.column, mine.key, mine.code) == tuple(
        theirs[name] for name in ("file", "line", "column", "key", "code")
    )
    theirs = program("convert", tmp_path / "none.h5", "-o", tmp_path / "v.csv", codes=(2,))["errors"][0]
    with pytest.raises(gs.DataError) as missing:
        gs.convert(tmp_path / "none.h5", tmp_path / "v.csv")
    assert missing.value.code == theirs["code"] == "missing_file"
    assert missing.value.file == theirs["file"] == str(tmp_path / "none.h5")
    (tmp_path / "bad.csv").write_text("x,y,u,v\n1,2,3,4\n1,2,3,4x\n")
    theirs = program("convert", tmp_path / "bad.csv", "-o", tmp_path / "v.h5", codes=(2,))["errors"][0]
    with pytest.raises(gs.DataError) as row:
        gs.convert(tmp_path / "bad.csv", tmp_path / "v.h5")
    assert (row.value.code, row.value.file, row.value.line) == ("syntax", str(tmp_path / "bad.csv"), 3)
    assert (theirs["code"], theirs["file"], theirs["line"]) == ("syntax", str(tmp_path / "bad.csv"), 3)
    assert pickle.loads(pickle.dumps(row.value)).line == 3
