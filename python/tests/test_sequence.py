"""Sequences: the files of the program, and their fields and statistics as arrays."""

import shutil
import struct

import numpy as np
import pytest

import gladstone as gs

SETTINGS = {"window": [32, 16], "overlap": 0.5}


@pytest.fixture
def frames(case, tmp_path):
    """Two pairs of the same images: A_0.tif, B_0.tif, A_1.tif, B_1.tif."""
    case.save(tmp_path / "case")
    folder = tmp_path / "frames"
    folder.mkdir()
    for k in range(2):
        shutil.copy(tmp_path / "case" / "reference.tif", folder / f"A_{k}.tif")
        shutil.copy(tmp_path / "case" / "flow.tif", folder / f"B_{k}.tif")
    return folder


def write_tiff(path, image):
    """Writes an uncompressed grey TIFF of 16 bits, which is read without the image codecs (wheels contain none)."""
    rows, columns = image.shape
    # width, height, bits, no compression, zero is black, offset of the samples, one channel, rows of the strip, bytes
    entries = [(256, columns), (257, rows), (258, 16), (259, 1), (262, 1), (273, 122), (277, 1), (278, rows)]
    entries.append((279, 2 * image.size))
    directory = b"".join(struct.pack("<HHII", tag, 3, 1, value) for tag, value in entries)
    header = struct.pack("<2sHIH", b"II", 42, 8, len(entries))
    path.write_bytes(header + directory + bytes(4) + image.astype("<u2").tobytes())


def test_fields_are_those_of_single_pairs(frames, case):
    sequence = gs.correlate_sequence([frames / "A_*.tif", frames / "B_*.tif"], device="cpu", **SETTINGS)
    single = gs.correlate(case.a, case.b, device="cpu", **SETTINGS)
    assert len(sequence) == 2 and sequence.failed == []
    fields = list(sequence)
    assert len(fields) == 2
    for field in fields:
        assert np.array_equal(field.u, single.u, equal_nan=True)
    assert sequence.device == "cpu" and sequence.seconds > 0


def test_statistics_are_those_of_the_fields(frames):
    sequence = gs.correlate_sequence(frames, device="cpu", **SETTINGS)
    statistics = sequence.statistics
    field = sequence[0]
    assert statistics["u_mean_px"].shape == field.shape
    # both pairs have the same images: the mean is either field, and the scatter is zero
    measured = statistics["count"] == 2
    assert measured.any()
    assert np.allclose(statistics["u_mean_px"][measured], field.u[measured], atol=1e-12)
    assert np.allclose(statistics["u_rms_px"][measured], 0, atol=1e-12)


def test_files_equal_those_of_the_program(frames, program, tmp_path):
    sequence = gs.correlate_sequence(frames, output=tmp_path / "module", device="cpu", **SETTINGS)
    program(
        "correlate", frames, "-o", tmp_path / "program/", "--pairing", "pairs",
        "--set", "correlate.window_px=[32, 16]", "--set", "correlate.overlap=0.5",
    )  # fmt: skip
    for k, pair in enumerate(sequence.pairs):
        assert np.array_equal(
            gs.Field.load(tmp_path / "program" / pair["vectors"]).u, sequence[k].u, equal_nan=True
        )


def test_same_call_continues(frames, tmp_path):
    for resumed in (False, True):
        sequence = gs.correlate_sequence(frames, output=tmp_path / "out", device="cpu", **SETTINGS)
        assert [pair["resumed"] for pair in sequence.pairs] == [resumed, resumed]


def test_consecutive_images(frames):
    sequence = gs.correlate_sequence(frames, pairing="consecutive", device="cpu", **SETTINGS)
    assert len(sequence) == 3


def test_bad_pair_is_reported(frames, codes):
    (frames / "B_1.tif").write_bytes(b"no image")
    with pytest.warns(gs.GladstoneWarning, match="B_1.tif") as caught:
        sequence = gs.correlate_sequence(frames, device="cpu", **SETTINGS)
    assert codes(caught) == ["failed at A_1.h5"]
    assert sequence.failed == [1] and "B_1.tif" in sequence.pairs[1]["error"]
    assert len(list(sequence)) == 1
    with pytest.raises(ValueError, match="B_1.tif"):
        sequence[1]


def test_pair_without_valid_vector_has_failed(frames, case):
    for name in ("A_1.tif", "B_1.tif"):
        write_tiff(frames / name, np.full(case.a.shape, 7))
    with pytest.warns(gs.GladstoneWarning):
        sequence = gs.correlate_sequence(frames, device="cpu", **SETTINGS)
    assert sequence.failed == [1] and len(list(sequence)) == 1


def test_sequence_without_any_vector_is_an_error(frames, refused):
    for name in ("B_0.tif", "B_1.tif"):
        (frames / name).write_bytes(b"no image")
    with pytest.warns(gs.GladstoneWarning), refused(gs.DataError, "undetermined at vectors", "2 pairs"):
        gs.correlate_sequence(frames, device="cpu", **SETTINGS)
    with pytest.raises(gs.DataError) as missing:
        gs.correlate_sequence(frames / "nothing.tif", device="cpu", **SETTINGS)
    assert missing.value.code == "missing_file"


def test_wrong_arguments_are_reported(frames, refused):
    with pytest.raises(gs.SetupError):
        gs.correlate_sequence(frames, window=[31])
    with refused(gs.DataError, "arguments at pairing"):
        gs.correlate_sequence(frames, pairing="all")
    with refused(gs.DataError, "missing_file at C_*.tif"):
        gs.correlate_sequence(frames / "C_*.tif")


def test_progress_counts_pairs(frames):
    calls = []
    gs.correlate_sequence(frames, device="cpu", progress=lambda *call: calls.append(call), **SETTINGS)
    assert calls[-1][1:] == (2, 2)


def test_tracks_continue_through_consecutive_images(tmp_path):
    # Gaussian particles that move by (2, 1) px from image to image
    random = np.random.default_rng(1)
    start = random.random((150, 2)) * 80 - 8
    row, column = np.mgrid[0:64, 0:64]
    for k in range(4):
        image = np.full((64, 64), 1000.0)
        for x, y in start + np.array([2.0, 1.0]) * k:
            image += 20000 * np.exp(-((column - x) ** 2 + (row - y) ** 2) / (2 * 0.75**2))
        write_tiff(tmp_path / f"img_{k}.tif", np.rint(image.clip(0, 65535)))
    sequence = gs.correlate_sequence(
        tmp_path / "img_*.tif", pairing="consecutive", device="cpu", method="tracking", **SETTINGS
    )
    ends = {}
    continued = 0
    for k in range(len(sequence)):
        dots = sequence.dots(k)
        valid = dots["status"] == 0
        at = np.stack([dots["x_px"], dots["y_px"]], axis=-1)[valid]
        half = np.stack([dots["u_px"], dots["v_px"]], axis=-1)[valid] / 2
        for track, a, b in zip(dots["track"][valid], at - half, at + half):
            if track in ends:
                assert np.allclose(a, ends[track], atol=1e-6)
                continued += 1
            ends[track] = b
    assert continued > 50
    with pytest.raises(ValueError):
        gs.correlate_sequence(tmp_path / "img_*.tif", pairing="consecutive", device="cpu", **SETTINGS).dots(0)


def test_statistics_are_drawn(frames):
    pytest.importorskip("matplotlib").use("agg")
    figure = gs.correlate_sequence(frames, device="cpu", **SETTINGS).plot()
    assert len([axis for axis in figure.axes if axis.get_title()]) == 4


def test_setup_without_a_sequence_is_refused(piv, tmp_path, refused):
    with refused(gs.SetupError, "missing_key at sequence") as caught:
        gs.render_sequence(piv, tmp_path / "frames")
    assert caught.value.problems[0].key == "sequence"
    assert not (tmp_path / "frames").exists()
