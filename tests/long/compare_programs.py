"""Runs two versions of the program on the same setups and compares all output files value by value: frames, truth,
vectors and errors must be equal to the bit.

    python3 -B tests/long/compare_programs.py OLD NEW [--setups 50] [--seed 1] [--out DIR] [--ignore PATTERN]...

The setups are the shipped ones (studies/cases and the templates of `gladstone init`), reduced in size, a random case of
each shipped study, and setups drawn at random (random_setups.py). Times, dates and the version of the program are not
compared, and figures are not drawn. A difference is a row of the printed table. A setup that both programs refuse with
the same exit code counts as equal. Exit code: 0 all equal, 1 differences, 2 wrong arguments, 130 interrupted.
"""

import argparse
import fnmatch
import json
import math
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from typing import NamedTuple

import compare_files
import random_setups
from compare_files import Difference
from random_setups import ROOT, Draw, draw_setup, write_setup, write_value

CASES = os.path.join(ROOT, "studies/cases")
TEMPLATES = os.path.join(ROOT, "studies/commands/templates")
MOST_PIXELS, MOST_RAYS = 96, 64  # of a shipped setup
WRITTEN = (0, 1)  # exit codes of a command that has written its files; 1: a check failed


class Setup(NamedTuple):
    name: str
    file: str  # the setup (TOML)
    overrides: list  # KEY=VALUE


class Outcome(NamedTuple):
    command: str
    code: int
    message: str


class Program:
    """One of the two programs; runs commands in its own folder of each setup."""

    def __init__(self, path, device):
        self.path, self.device = os.path.abspath(path), device
        if not os.access(self.path, os.X_OK):
            raise SystemExit(f"compare_programs: {path} is not an executable file")
        listed = subprocess.run([self.path, "keys", "--json"], check=True, capture_output=True)
        self.keys = json.loads(listed.stdout)["keys"]

    def words(self):
        """Returns the words that each key of a setup accepts."""
        return {key["key"]: re.findall(r'"([^"]+)"', key["values"]) for key in self.keys}

    def run(self, folder, *arguments):
        """Returns the exit code and the last line of stderr."""
        command = [self.path, *arguments, "--quiet", "--device", self.device]
        process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True, errors="replace")
        try:
            _, err = process.communicate()
        except BaseException:
            process.kill()
            process.wait()
            raise
        lines = [line for line in err.splitlines() if line.strip() and not line.startswith("warning")]
        return process.returncode, lines[-1] if lines else ""

    def run_setup(self, folder, setup):
        """Renders, correlates and compares. Returns the exit code and the message of each command."""
        os.makedirs(folder)
        overrides = [word for override in setup.overrides for word in ("--set", override)]
        outcomes = []

        def succeed(*arguments):
            code, message = self.run(folder, *arguments)
            outcomes.append(Outcome(arguments[0], code, message))
            return code in WRITTEN

        if not succeed("render", setup.file, "-o", "case", *overrides):
            return outcomes
        if os.path.exists(os.path.join(folder, "case/plane_000.tif")):
            succeed("calibrate", "case", "--no-figures")
            return outcomes
        cameras = sorted(os.path.dirname(path) for path in compare_files.list_files(os.path.join(folder, "case"))
                         if os.path.basename(path) == "truth.h5")
        for camera in cameras:
            case = os.path.join("case", camera)
            if succeed("correlate", case):
                succeed("convert", os.path.join(case, "vectors.h5"), "-o", os.path.join(case, "vectors.csv"))
                succeed("compare", case, "--no-figures")
        if len(cameras) == 2:
            succeed("stereo", *(os.path.join("case", camera) for camera in cameras), "-o", "uvw.h5", "--no-figures")
        return outcomes


def absolute_files(value, folder):
    """Returns a value of a study with the names of files relative to the study made absolute."""
    if isinstance(value, dict):
        return {key: absolute_files(one, folder) for key, one in value.items()}
    if isinstance(value, str) and "/" in value and os.path.exists(os.path.join(folder, value)):
        return os.path.normpath(os.path.join(folder, value))
    return value


def reduce_size(table):
    """Returns overrides that make a shipped setup small; none for a calibration, which needs many dots."""
    overrides = []
    camera = table.get("camera", {})
    if isinstance(camera, dict) and table.get("experiment") != "calibration":
        pixels = camera.get("pixels", [512, 512])
        if max(pixels) > MOST_PIXELS:
            overrides.append(f"camera.pixels={[min(count, MOST_PIXELS) for count in pixels]}")
    rays = table.get("render", {}).get("rays_per_dot")
    if isinstance(rays, int) and rays > MOST_RAYS:
        overrides.append(f"render.rays_per_dot={MOST_RAYS}")
    return overrides


def read_table(path):
    with open(path, "rb") as file:
        return tomllib.load(file)


def study_case(rng, path, table, full):
    """Returns a random case of a study: its base with one value of each axis."""
    base = os.path.join(os.path.dirname(path), table["base"])
    overrides = [] if full else reduce_size(read_table(base))
    for key, values in table["axes"].items():
        value = rng.choice(values) if isinstance(values, list) else next(iter(values.values()))[0]
        if isinstance(value, dict) and "label" in value:
            value = value.get("value", {name: one for name, one in value.items() if name != "label"})
        if key == "render.rays_per_dot" and not full:
            value = MOST_RAYS
        overrides = [one for one in overrides if not one.startswith(f"{key}=")]
        overrides.append(f"{key}={write_value(absolute_files(value, os.path.dirname(path)))}")
    return Setup(os.path.basename(path), base, overrides)


def shipped_setups(rng, full):
    """Returns all setups of studies/cases and the templates, and a random case of each study."""
    setups = []
    for top in (CASES, TEMPLATES):
        for path in sorted(os.path.join(top, name) for name in compare_files.list_files(top) if name.endswith(".toml")):
            table = read_table(path)
            if "axes" in table:
                if top == CASES:
                    setups.append(study_case(rng, path, table, full))
            else:
                setups.append(Setup(os.path.relpath(path, ROOT), path, [] if full else reduce_size(table)))
    return setups


def random_setup(index, seed, offers, work):
    """Draws a setup, which depends on seed and index only, and writes it."""
    folder = os.path.join(work, "setups", f"random_{index}")
    os.makedirs(folder)
    setup = draw_setup(Draw(random.Random(f"{seed}/{index}"), offers, folder))
    path = os.path.join(folder, "setup.toml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(write_setup(setup) + "\n")
    return Setup(f"random_{index}", path, [])


def compare_setup(programs, setup, work):
    """Returns the differences of one setup, and the message of a command that both programs refuse, or None."""
    folders = [os.path.join(work, name, re.sub(r"\W+", "_", setup.name)) for name in ("old", "new")]
    old, new = (program.run_setup(folder, setup) for program, folder in zip(programs, folders))
    differences = compare_files.compare_folders(*folders)
    codes = [", ".join(f"{one.command} {one.code}" for one in outcomes) for outcomes in (old, new)]
    crashed = any(one.code < 0 for one in old + new)  # by a signal: wrong even if both programs crash
    if codes[0] != codes[1] or crashed:
        differences.append(Difference("(exit codes)", "", math.nan, math.nan, " -> ".join(codes)))
    refused = next((one for one in new if one.code not in WRITTEN), None) if codes[0] == codes[1] else None
    if not differences:
        for folder in folders:
            shutil.rmtree(folder)
    return differences, refused


class Progress:
    """Reports on stderr how many setups are done and the remaining time."""

    def __init__(self, number):
        self.number, self.start, self.on_terminal = number, time.monotonic(), sys.stderr.isatty()

    def report(self, done, name, differing):
        passed = time.monotonic() - self.start
        left = f", {self.duration(passed / done * (self.number - done))} left" if done else ""
        line = f"setup {done + 1} of {self.number} ({name}), {differing} differ{left}"
        if self.on_terminal:
            print(f"\r{line:<100.100}", end="", file=sys.stderr, flush=True)
        else:
            print(line, file=sys.stderr, flush=True)

    def end(self):
        if self.on_terminal:
            print("\r" + " " * 100, end="\r", file=sys.stderr, flush=True)

    @staticmethod
    def duration(seconds):
        return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def print_table(differences):
    print("| file | dataset | setups | largest absolute | largest relative | largest in |\n|---|---|---|---|---|---|")
    for file, dataset, number, absolute, relative, text in compare_files.summarize(differences):
        words = ["" if math.isnan(value) else f"{value:.3g}" for value in (absolute, relative)]
        cell = text.replace("|", "\\|").replace("\n", "\\n")
        print(f"| {file} | {dataset} | {number} | {words[0]} | {words[1]} | {cell} |")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", metavar="OLD", help="program whose results are the reference")
    parser.add_argument("new", metavar="NEW", help="program to compare with it")
    parser.add_argument("--setups", type=int, default=50, metavar="N", help="number of random setups (50)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the random setups (1)")
    parser.add_argument("--index", type=int, help="only this random setup, to repeat a difference")
    parser.add_argument("--only", metavar="PATTERN", help="only the shipped setups with such a name")
    parser.add_argument("--no-shipped", action="store_true", help="random setups only")
    parser.add_argument("--full", action="store_true", help="shipped setups in full size")
    parser.add_argument("--device", default="cpu", choices=["cpu", "cuda"])
    parser.add_argument("--out", metavar="DIR", help="new folder for the setups, and the results of those that differ")
    parser.add_argument("--ignore", action="append", default=[], metavar="PATTERN",
                        help='accepted differences, as FILE:DATASET with wildcards: "*summary.json:rays_planned*"')
    arguments = parser.parse_args()
    if arguments.out and os.path.exists(arguments.out) and os.listdir(arguments.out):
        parser.error(f"{arguments.out} is not empty")
    return arguments


def list_setups(arguments, offers, work):
    setups = []
    if arguments.index is None and not arguments.no_shipped:
        setups = shipped_setups(random.Random(arguments.seed), arguments.full)
    if arguments.only:
        return [setup for setup in setups if fnmatch.fnmatch(setup.name, arguments.only)]
    indices = range(arguments.setups) if arguments.index is None else [arguments.index]
    return setups + [random_setup(index, arguments.seed, offers, work) for index in indices]


def compare(arguments, work):
    """Compares all setups and prints the results, also those so far if interrupted. Returns the exit code."""
    programs = [Program(path, arguments.device) for path in (arguments.old, arguments.new)]
    old, new = (program.words() for program in programs)
    offers = {key: [word for word in words if word in new[key]] for key, words in old.items() if key in new}
    setups = list_setups(arguments, offers, work)
    progress = Progress(len(setups))
    differences, differing, refused, done, interrupted = [], [], [], 0, False
    try:
        for done, setup in enumerate(setups):
            progress.report(done, setup.name, len(differing))
            found, refusal = compare_setup(programs, setup, work)
            found = [one for one in found
                     if not any(fnmatch.fnmatch(f"{one.file}:{one.dataset}", pattern) for pattern in arguments.ignore)]
            differences += [(setup.name, one) for one in found]
            if found:
                differing.append(setup.name)
            if refusal:
                refused.append(f"{setup.name}: {refusal.command} {refusal.code} of both programs: {refusal.message}")
        done = len(setups)
    except KeyboardInterrupt:
        interrupted = True
    progress.end()
    for line in refused:
        print(line, file=sys.stderr)
    if differences:
        print_table(differences)
    print(f"seed {arguments.seed}: {done} of {len(setups)} setups, {done - len(differing)} equal, "
          f"{len(differing)} differ, {len(refused)} refused by both, {time.monotonic() - progress.start:.0f} s")
    return 130 if interrupted else 1 if differences else 0


def main():
    arguments = parse_arguments()
    work = os.path.abspath(arguments.out or tempfile.mkdtemp(prefix="gladstone_compare_"))
    os.makedirs(work, exist_ok=True)
    try:
        return compare(arguments, work)
    except KeyboardInterrupt:
        return 130
    finally:
        if not arguments.out:
            shutil.rmtree(work, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
