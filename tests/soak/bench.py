"""The small experiments that the soak test disturbs, and their results without disturbance."""

import csv
import json
import os
import resource
import shutil
import signal
import struct
import subprocess
import time

SETUP = """schema = 1
experiment = "bos"
[camera]
pixels = [64, 64]
pixel_pitch_um = 10.0
[lens]
focal_length_mm = 105.0
f_number = 11.0
[geometry]
z_a_mm = 750.0
z_d_mm = 250.0
[medium.field]
kind = "file"
file = "{field}"
spacing_mm = [0.5, 0.5, 5.0]
[target]
dots_per_32px_window = 10.0
[render]
rays_per_dot = {rays}
[correlate]
window_px = [32, 16]
"""

STUDY = """base = "setup.toml"
[axes]
"lens.f_number" = [8, 11, 16]
"geometry.z_d_mm" = [250, 300]
[study]
repeats = 2
"""


class Wrong(Exception):
    """Forbidden behaviour of the program."""


def field(slope):
    """A NRRD volume of 40 x 40 x 2 nodes whose density rises along x."""
    head = "NRRD0004\ntype: double\ndimension: 3\nsizes: 40 40 2\nendian: little\nencoding: raw\n\n"
    values = [1.2 + slope * 1e-5 * (i % 40) ** 2 for i in range(40 * 40 * 2)]
    return head.encode() + struct.pack(f"<{len(values)}d", *values)


def write(path, content):
    """Writes a file by one rename, like editors and copying tools."""
    with open(path + "~", "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    os.rename(path + "~", path)


def read(path):
    with open(path, "rb") as file:
        return file.read()


def names(folder):
    return sorted(os.path.relpath(os.path.join(at, name), folder)
                  for at, folders, files in os.walk(folder) for name in folders + files)


class Bench:
    """Runs the program in one folder; the experiments "a" and "b" have different dots and displacements."""

    def __init__(self, program, folder):
        self.program, self.folder = os.path.abspath(program), folder
        self.seconds, self.results = {}, {}
        os.makedirs(folder)
        for kind, slope in (("a", 1.0), ("b", -2.0)):
            write(self.at(f"{kind}.nrrd"), field(slope))
            write(self.at(f"{kind}.toml"), SETUP.format(field=f"{kind}.nrrd", rays=32 if kind == "a" else 48))
        self.known = {kind: self.measure(kind) for kind in "ab"}
        if self.known["a"]["errors"] == self.known["b"]["errors"]:
            raise Wrong("the two experiments give the same errors")
        self.plan_study(self.at("known_study"))
        start = time.monotonic()
        self.succeed("sweep", "run", self.at("known_study/run"), "--quiet")
        self.seconds["sweep"] = time.monotonic() - start
        self.known_study = self.collected(self.at("known_study/run"))

    def at(self, name):
        return os.path.join(self.folder, name)

    def start(self, *arguments, limit_bytes=None, stop_at=None):
        """@param stop_at point at which the program stops itself (CONTRIBUTING.md), for wait_until_stopped()"""
        def prepare():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # a full disk causes a write error, not a signal
            if limit_bytes is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, limit_bytes))
        return subprocess.Popen([self.program, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, errors="replace", preexec_fn=prepare,
                                start_new_session=True, env=os.environ | {"GLADSTONE_STOP_AT": stop_at or ""})

    @staticmethod
    def wait_until_stopped(process):
        """Waits until the process has stopped itself, or has ended without reaching the point."""
        os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)

    def finish(self, process, seconds=120):
        """Returns exit code and stderr; raises Wrong for a run without end, or ended by a signal not sent by the test."""
        try:
            _, err = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            raise Wrong(f"no end after {seconds} s: {' '.join(process.args[1:])}") from None
        if process.returncode not in (0, 2, 3, 130, -signal.SIGKILL):
            raise Wrong(f"{' '.join(process.args[1:])} ended with {process.returncode}: {err.strip()}")
        return process.returncode, err

    def run(self, *arguments, **limits):
        return self.finish(self.start(*arguments, **limits))

    def succeed(self, *arguments):
        code, err = self.run(*arguments)
        if code != 0:
            raise Wrong(f"{' '.join(arguments)} ended with {code}: {err.strip()}")

    def measure(self, kind):
        case = self.at(f"known_{kind}")
        for arguments in (("render", self.at(f"{kind}.toml"), "-o", case), ("correlate", case), ("compare", case)):
            start = time.monotonic()
            self.succeed(*arguments, "--quiet")
            self.seconds[arguments[0]] = time.monotonic() - start
        return {"frames": self.frames(case), "pixel_hashes": self.pixel_hashes(case), "errors": self.errors(case),
                "files": names(case)}

    @staticmethod
    def frames(case):
        return [read(os.path.join(case, name)) for name in ("reference.tif", "flow.tif")]

    @staticmethod
    def pixel_hashes(case):
        """Hashes of both frames; equal for equal pixels, whatever the names of the setup and its files."""
        summary = json.loads(read(os.path.join(case, "summary.json")))
        return [summary["reference_sha256"], summary["flow_sha256"]]

    @staticmethod
    def errors(case):
        """Errors against the ray truth in errors.json."""
        return json.loads(read(os.path.join(case, "errors.json")))["ray_truth"]

    def kind_of(self, what, value):
        found = [kind for kind in "ab" if self.known[kind][what] == value]
        if not found:
            raise Wrong(f"{what} are those of neither experiment")
        return found[0]

    def state(self, case):
        """Returns "absent", "refused", "a" or "b"; raises Wrong if the case is accepted but is a mixture of both."""
        if not os.path.exists(case):
            return "absent"
        copy = self.at("copy")
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(case, copy)
        has = set(os.listdir(copy))
        errors = self.kind_of("errors", self.errors(copy)) if "errors.json" in has else None
        if "vectors.h5" in has and self.run("compare", copy, "--no-figures", "--quiet")[0] == 0:
            vectors = self.kind_of("errors", self.errors(copy))
            if self.kind_of("frames", self.frames(copy)) != vectors:
                raise Wrong("compare accepts vectors of other frames")
            if errors not in (None, vectors):
                raise Wrong("errors.json belongs to other vectors")
        if self.run("correlate", copy, "--quiet")[0] != 0:
            return "refused"
        if self.run("compare", copy, "--no-figures", "--quiet")[0] != 0:
            return "refused"
        frames = self.kind_of("frames", self.frames(copy))
        if self.kind_of("errors", self.errors(copy)) != frames:
            raise Wrong("the case's frames and truth belong to different experiments")
        return frames

    def expect_nothing_left(self, folder, wanted):
        """Raises Wrong if the folder contains other files than those wanted."""
        more = [name for name in names(folder) if name not in wanted]
        if more:
            raise Wrong(f"left behind: {', '.join(more)}")

    def plan_study(self, folder):
        os.makedirs(folder)
        shutil.copy(self.at("a.nrrd"), folder)
        write(os.path.join(folder, "setup.toml"), SETUP.format(field="a.nrrd", rays=32))
        write(os.path.join(folder, "study.toml"), STUDY)
        self.succeed("sweep", "plan", os.path.join(folder, "study.toml"), "-o", os.path.join(folder, "run"), "--device",
                     "cpu", "--quiet")

    def collected(self, run):
        """Returns the tables of a study, without times."""
        self.succeed("sweep", "collect", run, "--quiet")
        tables = []
        for name in ("study.csv", "study_points.csv"):
            with open(os.path.join(run, name), encoding="utf-8", newline="") as file:
                for row in csv.DictReader(file):
                    tables.append({key: value for key, value in row.items() if "seconds" not in key})
        return tables
