"""Faults of the commands that write one result: density, volume, three components, other formats, printed patterns,
tracked vectors; and of sequences, rendered or measured. Results have the same bytes in every run except for dates."""

import os
import re
import shutil
import time

from bench import Wrong, names, read, write
from faults import fault, kill, on_full_disk, sizes

# Name of the output, arguments of the result, and additional ones of an older result at the same place.
COMMANDS = {
    "reconstruct": ("density.h5", ["reconstruct", "known_a", "--reference", "left", "--no-figures"],
                    ["--reference", "right"]),
    "tomography": ("volume.h5", ["tomography", "known_a", "known_b", "view", "--reference", "left", "--no-figures"],
                   ["--iterations", "2"]),
    "stereo": ("uvw.h5", ["stereo", "stereo/left", "stereo/right", "--no-figures"], ["--dewarp", "images"]),
    "convert": ("uvw.vtp", ["convert", "stereo/uvw.h5"], None),
    "target": ("pattern.pdf", ["target", "a.toml"], ["--set", "target.seed=8"]),
    "tracking": ("vectors.csv", ["correlate", "known_a", "--set", 'correlate.method="tracking"'],
                 ["--set", 'correlate.tracking.output="scattered"']),
    "sequence": ("run", ["correlate", "frames/a*.tif", "frames/b*.tif", "--no-figures"], None),
    "film": ("film", ["render", "film.toml"], None),
    "consecutive": ("run", ["correlate", "film/frames", "--pairing", "consecutive", "--no-figures"], None),
    "tracks": ("run", ["correlate", "film/frames", "--pairing", "consecutive", "--no-figures",
                       "--set", 'correlate.method="tracking"'], None),
    "background": ("run", ["correlate", "film/frames", "--pairing", "consecutive", "--no-figures",
                           "--config", "background.toml"], None),
}

# Four frames of ideal particle images, which move by 2.3 px.
FILM = """experiment = "piv"
[sequence]
frames = 4
dt_us = 10.0
[camera]
pixels = [96, 96]
pixel_pitch_um = 10.0
[lens]
focal_length_mm = 105.0
f_number = 22.0
[geometry]
z_a_mm = 750.0
[particles]
per_pixel = 0.05
volume_mm = [9.0, 9.0, 1.0]
scattering = "gaussian"
[laser]
thickness_mm = 1.0
[flow]
velocity_m_s = [14.12857, 0.0, 0.0]
"""
BACKGROUND = """[correlate]
[[correlate.preprocess]]
kind = "background"
subtract = "minimum"
"""


def contents(path):
    """Bytes of a file, or of each file of a folder, without dates; None if there is none.

    summary.json of rendered cases contains times and is left out.
    """
    if os.path.basename(path) == "summary.json":
        return b""
    if os.path.isdir(path):
        return {name: contents(os.path.join(path, name)) for name in names(path)}
    return re.sub(rb"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", b"", read(path)) if os.path.exists(path) else None


def known_results(bench):
    """Writes the inputs of the commands, and their results without disturbance, on the first call."""
    if bench.results:
        return bench.results
    shutil.copytree(bench.at("known_a"), bench.at("view"))
    os.makedirs(bench.at("frames"))
    for number, kind in enumerate("aba"):
        shutil.copy(bench.at(f"known_{kind}/reference.tif"), bench.at(f"frames/a{number}.tif"))
        shutil.copy(bench.at(f"known_{kind}/flow.tif"), bench.at(f"frames/b{number}.tif"))
    write(bench.at("film.toml"), FILM)
    write(bench.at("background.toml"), BACKGROUND)
    bench.succeed("render", "film.toml", "-o", "film", "--quiet")
    bench.succeed("init", "stereo", "-o", "stereo.toml", "--quiet")
    bench.succeed("render", "stereo.toml", "-o", "stereo", "--quiet")
    for camera in ("left", "right"):
        bench.succeed("correlate", f"stereo/{camera}", "--quiet")
    bench.succeed("stereo", "stereo/left", "stereo/right", "-o", "stereo/uvw.h5", "--no-figures", "--quiet")
    for name, (output, arguments, old) in COMMANDS.items():
        for kind, more in (("new", []), ("old", old)):
            if more is not None:
                start = time.monotonic()
                bench.succeed(*arguments, *more, "-o", f"results/{name}/{kind}/{output}", "--quiet")
                if kind == "new":  # that is what is disturbed
                    bench.seconds[name] = time.monotonic() - start
        bench.results[name] = {kind: contents(bench.at(f"results/{name}/{kind}/{output}")) for kind in ("new", "old")}
        if bench.results[name]["new"] == bench.results[name]["old"]:
            raise Wrong(f"{name}: the older result does not differ")
    return bench.results


def draw_command(bench, rng, place):
    """Selects a command and, in half of the cases, puts an older result at its place."""
    name = rng.choice(sorted(COMMANDS))
    output, arguments, old = COMMANDS[name]
    known = known_results(bench)[name]
    path = os.path.join(place, output)
    has_old = old is not None and rng.random() < 0.5
    if has_old:
        shutil.copy(bench.at(f"results/{name}/old/{output}"), path)
    return name, path, [*arguments, "-o", path], known, has_old


def repeat(bench, place, name, path, arguments, known):
    """Runs the command without disturbance: its result must be the known one, without any other file."""
    bench.succeed(*arguments, "--quiet")
    if contents(path) != known["new"]:
        raise Wrong(f"{name} gives another result after the fault")
    wanted = [os.path.basename(path)]
    if os.path.isdir(path):
        wanted += [f"{wanted[0]}/{one}" for one in known["new"]]
    bench.expect_nothing_left(place, wanted)


@fault
def kill_command(bench, rng, place):
    """kill -9 of `reconstruct`, `tomography`, `stereo`, `convert`, `target`, tracking, or sequences of either kind."""
    name, path, arguments, known, has_old = draw_command(bench, rng, place)
    kill(bench, rng, bench.seconds[name], place, *arguments)
    state = contents(path)
    if not os.path.isdir(path) and state not in (known["new"], known["old"] if has_old else None):
        raise Wrong(f"{name} was killed, and its result is incomplete")
    repeat(bench, place, name, path, arguments, known)
    return name


@fault
def full_disk_command(bench, rng, place):
    """Any command with a limit of the file size."""
    name, path, arguments, known, has_old = draw_command(bench, rng, place)
    largest = max(len(one) for one in known["new"].values()) if isinstance(known["new"], dict) else len(known["new"])
    if os.path.isdir(bench.at(f"results/{name}/new/{COMMANDS[name][0]}")):
        code, err = bench.run(*arguments, "--quiet", limit_bytes=rng.randrange(0, largest))
        if code not in (2, 3):
            raise Wrong(f"exit code {code}: {err.strip()}")
    else:
        on_full_disk(bench, place, place, arguments, sizes(place), rng.randrange(0, largest))
        if contents(path) != (known["old"] if has_old else None):
            raise Wrong(f"{name} on a full disk changed the older result")
    repeat(bench, place, name, path, arguments, known)
    return name
