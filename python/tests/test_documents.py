"""The code of docs/python.md, run as it is written there."""

import ast
import pathlib
import re
import shutil

import pytest

import gladstone as gs

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "python.md"


def code_blocks() -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.DOTALL | re.MULTILINE)


# One small setup under all names that the page uses. The blocks run in their order, in one namespace.
def test_code_of_the_page_runs(bos, piv, tmp_path, monkeypatch):
    if not PAGE.exists():
        pytest.skip("the tests are not in the source tree, which contains docs/python.md")
    pytest.importorskip("matplotlib").use("agg")
    for name in ("pandas", "xarray"):
        pytest.importorskip(name)
    small = bos.replace({"camera.pixels": [160, 160], "correlate.window_px": [32]})
    (tmp_path / "studies" / "cases").mkdir(parents=True)
    small.save(tmp_path / "studies" / "cases" / "table1.toml")
    small.save(tmp_path / "setup.toml")
    (tmp_path / "stereo.toml").write_text(gs.init("stereo").replace("[192, 192]", "[128, 128]"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("gladstone._benchmark.benchmark_cases", lambda: ["vortex"])
    small.render(device="cpu").save(tmp_path / "case")
    for k in range(2):
        shutil.copy(tmp_path / "case" / "reference.tif", tmp_path / f"A_{k}.tif")
        shutil.copy(tmp_path / "case" / "flow.tif", tmp_path / f"B_{k}.tif")
    names = {"first_images": "A_*.tif", "second_images": "B_*.tif"}
    names |= {"my_network": lambda a, b: gs.correlate(a, b, window=32).to_xarray()}
    names["train"] = lambda images, flow: trained.append((images.shape, flow.shape))
    trained: list = []
    small_pairs = {"camera.pixels": [32, 24], "correlate.window_px": [16], "particles.scattering": "gaussian"}
    small_pairs["render.rays_per_dot"] = "auto"
    vortex = {"kind": "lamb_oseen", "circulation_m2_s": 0.05, "core_radius_mm": 1.0, "dt_us": 10.0}
    gs.Setup.from_dict(piv.replace(small_pairs).to_dict() | {"flow": vortex}).save(tmp_path / "piv.toml")
    blocks = code_blocks()
    assert len(blocks) >= 5
    for block in blocks:
        if "gladstone.torch" in block:
            try:
                import torch  # noqa: F401
            except ImportError:
                continue
        exec(compile(block, str(PAGE), "exec"), names)
        if "case" in names and "a" not in names:
            names.update(a=names["case"].a, b=names["case"].b)
    assert names["report"].rms_px > 0
    assert (tmp_path / "report.html").exists()
    assert names["data"]["u"].dims == ("y", "x", "t")
    assert {row["estimator"] for row in names["scores"]} == {"default", "mine"}
    assert len(names["table"]) == 9
    assert trained == [((64, 2, 24, 32), (64, 2, 24, 32))] * 10


# The example of the package, several cameras, and a preview, for type checkers.
TYPED = """
import gladstone as gs

setup = gs.Setup.from_file("table1.toml").replace({"lens.f_number": 16})
case = setup.render(progress=True)
field = gs.correlate(case.a, case.b, window=[64, 32, 24, 20])
print(case.compare(field))
known: gs.Case = setup.render()
print(known.compare(field).rms_px)
cases = gs.render("stereo.toml")
print(gs.stereo(cases["left"], cases["right"]), gs.preview(setup).images)
"""


def test_type_checkers_accept_the_example(tmp_path, monkeypatch):
    check = pytest.importorskip("mypy.api")
    (tmp_path / "example.py").write_text(TYPED)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MYPYPATH", str(pathlib.Path(gs.__file__).parents[1]))
    text, errors, code = check.run(["--follow-imports=silent", "--no-incremental", "example.py"])
    assert code == 0, text + errors


def test_type_stub_of_the_compiled_part_is_valid():
    stub = pathlib.Path(gs.__file__).with_name("_core.pyi")
    functions = {node.name for node in ast.parse(stub.read_text()).body if isinstance(node, ast.FunctionDef)}
    assert {"render", "correlate", "reconstruct"} <= functions


def test_every_public_name_has_a_docstring():
    for name in gs.__all__:
        member = getattr(gs, name)
        if name.startswith("__") or name == "info":
            continue
        assert member.__doc__, name
        for attribute, inner in vars(member).items() if isinstance(member, type) else ():
            if not attribute.startswith("_") and (callable(inner) or isinstance(inner, (property, classmethod))):
                assert inner.__doc__, f"{name}.{attribute}"
