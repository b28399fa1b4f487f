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
from ._benchmark import BenchmarkCase, Scores, benchmark, benchmark_cases, benchmark_estimators
from ._calibration import Calibration, calibrate
from ._case import Accuracy, CalibrationCase, Case, Truth
from ._core import set_threads, threads
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
)
from ._field import Field, correlate
from ._report import Report
from ._sequence import Sequence, correlate_sequence
from ._setup import Setup, render
from ._study import Study, StudyRun
from ._tomography import Tomography, reconstruct_lines, tomography
from ._trace import TracedRays, trace
from ._version import __version__, build
from .info import Mie, mie


def compare(case: Case, field, **options) -> Report:
    """Compares measured vectors with truth and theory; see `Case.compare`."""
    return case.compare(field, **options)


__all__ = [
    "Accuracy", "BenchmarkCase", "Calibration", "CalibrationCase", "Case", "DataError", "Density", "Design",
    "DeviceError", "Error", "Field", "GladstoneWarning", "Mie", "NoValidVector", "OutOfMemory", "OutputError",
    "Problem", "Report", "Scores", "Sequence", "Setup", "SetupError", "Study", "StudyRun", "Tomography", "TracedRays", "Truth",
    "__version__", "benchmark", "benchmark_cases", "benchmark_estimators", "build", "calibrate", "compare",
    "correlate", "correlate_sequence", "design", "info", "mie", "reconstruct", "reconstruct_lines", "render", "set_threads",
    "threads", "tomography", "trace",
]  # fmt: skip
