"""gladstone: design of background oriented schlieren (BOS) and PIV experiments, and the error of their measurement.

    import gladstone as gs

    setup = gs.Setup.from_file("table1.toml").replace({"lens.f_number": 16})
    case = setup.render(progress=True)
    field = gs.correlate(case.a, case.b, window=[64, 32, 24, 20])
    print(case.compare(field))

Results are equal bit by bit to those of the program gladstone. Units are in the names: _mm, _m, _px. Images and maps
are [rows, columns]; displacements are in px from frame a to frame b, u to the right and v downwards.
"""

from . import info
from ._batches import Batch, RenderedBatches
from ._benchmark import BenchmarkCase, Scores, benchmark, benchmark_cases, benchmark_estimators
from ._calibration import Calibration, calibrate
from ._calibration_case import CalibrationCase
from ._case import Accuracy, Case, Truth
from ._commands import Oracle, convert, demo, gallery, render_sequence, report, validate, views
from ._correlate import correlate, correlate_ensemble
from ._density import Density, reconstruct
from ._design import Design, design
from ._errors import (
    DataError,
    DeviceError,
    Error,
    GladstoneWarning,
    NoValidVector,
    OutOfMemory,
    OutputError,
    Problem,
    SetupError,
    WarningText,
)
from ._field import Field
from ._preview import Preview, preview, target
from ._report import Report
from ._sequence import Sequence, correlate_sequence
from ._setup import Setup, render
from ._stereo import ThreeComponents, stereo
from ._study import Study, StudyRun
from ._templates import SetupKey, init, keys, shared_folder
from ._threads import set_threads, threads
from ._tomography import Tomography, reconstruct_lines, tomography, tomography_setups
from ._trace import TracedRays, trace
from ._version import __version__, build
from .info import Mie, mie


def compare(case: Case, field, **options) -> Report:
    """Compares measured vectors with truth and theory; see `Case.compare`."""
    return case.compare(field, **options)


__all__ = [
    "Accuracy", "Batch", "BenchmarkCase", "Calibration", "CalibrationCase", "Case", "DataError", "Density", "Design",
    "DeviceError", "Error", "Field", "GladstoneWarning", "Mie", "NoValidVector", "Oracle", "OutOfMemory", "OutputError",
    "Preview", "Problem", "RenderedBatches", "Report", "Scores", "Sequence", "Setup", "SetupError", "SetupKey", "Study",
    "StudyRun", "ThreeComponents", "Tomography", "TracedRays", "Truth", "WarningText", "__version__", "benchmark", "benchmark_cases",
    "benchmark_estimators", "build", "calibrate", "compare", "convert", "correlate", "correlate_ensemble",
    "correlate_sequence", "demo", "design", "gallery", "info", "init", "keys", "mie", "preview", "reconstruct",
    "reconstruct_lines", "render", "render_sequence", "report", "set_threads", "shared_folder", "stereo", "target",
    "threads", "tomography", "tomography_setups", "trace", "validate", "views",
]  # fmt: skip
