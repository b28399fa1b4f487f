"""The faults of the soak test: each function disturbs one command, checks the resulting files, and returns the outcome.

Existing files must be complete, results must belong to their sources, no temporary file may remain that the next run
does not delete, and a resumed run must give the results of an undisturbed one."""

import os
import shutil
import signal
import subprocess
import threading
import time

from bench import SETUP, Wrong, field, names, write

ALL = {}


def fault(function):
    ALL[function.__name__] = function
    return function


def wait_for_moment(rng, process, seconds, folder):
    """Waits until a random moment of a run of that duration, or shortly after the first change in the folder."""
    if rng.random() < 0.5:
        limit = time.monotonic() + rng.uniform(0.0, 1.1 * seconds)
        while process.poll() is None and time.monotonic() < limit:
            time.sleep(0.001)
        return
    before = set(os.listdir(folder))
    while process.poll() is None and set(os.listdir(folder)) == before:
        time.sleep(0.0005)
    time.sleep(rng.uniform(0.0, 0.1))


def strike(process, number, whole_group=True):
    if process.poll() is None:
        os.killpg(process.pid, number) if whole_group else os.kill(process.pid, number)


# Stop points of commands: the same state in every run with one seed.
POINTS = {
    "render": ["rendering", "file-written", "file-written:4", "replacement-begun", "replacement-retired",
               "replacement-installed"],
    "correlate": ["correlating", "file-written"],
    "compare": ["comparing", "file-written"],
}


def kill(bench, rng, seconds, folder, *arguments):
    """Kills a run at a stop point or at a random moment; the requirements are the same if it has already ended."""
    point = rng.choice(POINTS.get(arguments[0], [None])) if rng.random() < 0.5 else None
    process = bench.start(*arguments, "--quiet", stop_at=point)
    if point:
        bench.wait_until_stopped(process)
    else:
        wait_for_moment(rng, process, seconds, folder)
    strike(process, signal.SIGKILL)
    return bench.finish(process)[0]


def case_files(bench, kind):
    return ["case"] + [f"case/{name}" for name in bench.known[kind]["files"]]


def whole_case(bench, place, kind):
    """Renders, correlates and compares; afterwards there must be only the case, with the known numbers."""
    case = os.path.join(place, "case")
    for arguments in (("render", bench.at(f"{kind}.toml"), "-o", case), ("correlate", case),
                      ("compare", case, "--no-figures")):
        bench.succeed(*arguments, "--quiet")
    if bench.errors(case) != bench.known[kind]["errors"]:
        raise Wrong("after the fault the same commands give other errors")
    bench.expect_nothing_left(place, case_files(bench, kind))


def fresh_case(bench, place, kind):
    shutil.copytree(bench.at(f"known_{kind}"), os.path.join(place, "case"))


@fault
def kill_render(bench, rng, place):
    """kill -9 of `render` to a new folder."""
    case = os.path.join(place, "case")
    kill(bench, rng, bench.seconds["render"], place, "render", bench.at("a.toml"), "-o", case)
    state = bench.state(case)
    if state == "b":
        raise Wrong("another experiment than the one rendered")
    whole_case(bench, place, "a")
    return state


@fault
def kill_render_over(bench, rng, place):
    """kill -9 of `render` over a finished case of another setup."""
    fresh_case(bench, place, "b")
    case = os.path.join(place, "case")
    kill(bench, rng, bench.seconds["render"], rng.choice([place, case]), "render", bench.at("a.toml"), "-o", case)
    state = bench.state(case)
    if state == "absent":
        raise Wrong("the old case was removed without a new one")
    whole_case(bench, place, "a")
    return {"a": "new", "b": "old"}.get(state, state)


@fault
def kill_correlate(bench, rng, place):
    """kill -9 of `correlate` in a case that has results."""
    fresh_case(bench, place, "a")
    case = os.path.join(place, "case")
    kill(bench, rng, bench.seconds["correlate"], case, "correlate", case)
    state = bench.state(case)
    if state != "a":
        raise Wrong(f"the case is {state}")
    whole_case(bench, place, "a")
    return "whole"


@fault
def kill_compare(bench, rng, place):
    """kill -9 of `compare` in a case that has errors.json and figures."""
    fresh_case(bench, place, "a")
    case = os.path.join(place, "case")
    kill(bench, rng, bench.seconds["compare"], case, "compare", case)
    state = bench.state(case)
    if state != "a":
        raise Wrong(f"the case is {state}")
    whole_case(bench, place, "a")
    return "whole"


@fault
def interrupt(bench, rng, place):
    """SIGINT, SIGTERM or SIGHUP while a case is rendered over another one."""
    fresh_case(bench, place, "b")
    case = os.path.join(place, "case")
    process = bench.start("render", bench.at("a.toml"), "-o", case, "--quiet")
    wait_for_moment(rng, process, bench.seconds["render"], place)
    number = rng.choice([signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
    running = process.poll() is None
    strike(process, number, whole_group=False)
    _, err = process.communicate()
    early = process.returncode == -number  # before the program handles signals
    if process.returncode not in (0, 130) and not (running and early):
        raise Wrong(f"after {signal.Signals(number).name} it exited with code {process.returncode}: {err.strip()}")
    state = bench.state(case)
    if state not in ("a", "b"):
        raise Wrong(f"after {signal.Signals(number).name} the case is {state}")
    bench.expect_nothing_left(place, case_files(bench, "a"))
    whole_case(bench, place, "a")
    return {"a": "new", "b": "old"}[state]


def finish_study(bench, place, *options):
    run = os.path.join(place, "study/run")
    partials = [name for name in names(run) if "partial" in name]
    for name in partials:  # as if the writer had ended yesterday
        os.utime(os.path.join(run, name), (time.time() - 86400,) * 2)
    bench.succeed("sweep", "run", run, "--quiet", *options)
    if bench.collected(run) != bench.known_study:
        raise Wrong("the resumed study differs from the uninterrupted one")
    left = [name for name in names(run) if "partial" in name or os.path.basename(name).startswith(".")]
    if left:
        raise Wrong(f"left behind: {', '.join(left)}")


@fault
def kill_sweep(bench, rng, place):
    """kill -9 of `sweep run`, up to three times, of the first process or of all."""
    bench.plan_study(os.path.join(place, "study"))
    run = os.path.join(place, "study/run")
    jobs = rng.choice(["1", "2"])
    kills = rng.randint(1, 3)
    for _ in range(kills):
        process = bench.start("sweep", "run", run, "--quiet", "--jobs", jobs)
        wait_for_moment(rng, process, bench.seconds["sweep"], os.path.join(run, "cases"))
        strike(process, signal.SIGKILL, whole_group=rng.random() < 0.7)
        bench.finish(process)
    finish_study(bench, place)
    return f"{kills} kills"


@fault
def kill_plan(bench, rng, place):
    """kill -9 of `sweep plan`."""
    study = os.path.join(place, "study")
    bench.plan_study(study)
    shutil.rmtree(os.path.join(study, "run"))
    arguments = ("sweep", "plan", os.path.join(study, "study.toml"), "-o", os.path.join(study, "run"), "--device", "cpu")
    kill(bench, rng, 0.1, study, *arguments)
    planned = os.path.exists(os.path.join(study, "run/manifest.jsonl"))
    bench.succeed(*arguments, "--quiet")
    finish_study(bench, place)
    bench.expect_nothing_left(study, [name for name in names(study) if name.split("/")[0] in
                                      ("run", "a.nrrd", "setup.toml", "study.toml")])
    return "planned" if planned else "not planned"


@fault
def replaced_frames(bench, rng, place):
    """`correlate` while `render` replaces the case, then `compare`."""
    fresh_case(bench, place, "b")
    case = os.path.join(place, "case")
    render = bench.start("render", bench.at("a.toml"), "-o", case, "--quiet")
    wait_for_moment(rng, render, bench.seconds["render"], place)
    code, _ = bench.run("correlate", case, "--quiet")
    bench.finish(render)
    compared, _ = bench.run("compare", case, "--no-figures", "--quiet")
    state = bench.state(case)
    if state != "a":
        raise Wrong(f"the case is {state}")
    whole_case(bench, place, "a")
    return f"correlate {code}, compare {compared}"


@fault
def replaced_field(bench, rng, place):
    """The field file of a setup is replaced while it is rendered."""
    write(os.path.join(place, "field.nrrd"), field(-2.0))
    write(os.path.join(place, "setup.toml"), SETUP.format(field="field.nrrd", rays=32))
    case = os.path.join(place, "case")
    render = bench.start("render", os.path.join(place, "setup.toml"), "-o", case, "--quiet")
    time.sleep(rng.uniform(0.0, bench.seconds["render"]))
    write(os.path.join(place, "field.nrrd"), field(1.0))
    code, _ = bench.finish(render)
    if code != 0:
        return "refused"
    new = bench.pixel_hashes(case) == bench.known["a"]["pixel_hashes"]
    bench.succeed("correlate", case, "--quiet")
    compared, _ = bench.run("compare", case, "--no-figures", "--quiet")
    if compared == 0 and not new:
        raise Wrong("compare accepts the truth of one field for frames of another")
    return "new" if new else "old, compare refuses"


@fault
def replaced_field_in_sweep(bench, rng, place):
    """The field file of a study is replaced while it runs, and restored before it is resumed."""
    bench.plan_study(os.path.join(place, "study"))
    run, file = os.path.join(place, "study/run"), os.path.join(place, "study/a.nrrd")
    process = bench.start("sweep", "run", run, "--quiet")
    time.sleep(rng.uniform(0.0, bench.seconds["sweep"]))
    write(file, field(-2.0))
    code, _ = bench.finish(process)
    write(file, field(1.0))
    finish_study(bench, place, "--retry-failed")
    return f"run {code}"


@fault
def two_renders(bench, rng, place):
    """Two programs render different setups into one case."""
    case = os.path.join(place, "case")
    if rng.random() < 0.5:
        fresh_case(bench, place, rng.choice("ab"))
    processes = []
    for kind in "ab":
        processes.append(bench.start("render", bench.at(f"{kind}.toml"), "-o", case, "--quiet"))
        time.sleep(rng.uniform(0.0, 0.5 * bench.seconds["render"]))
    codes = sorted(bench.finish(process)[0] for process in processes)
    if codes[0] != 0:
        raise Wrong(f"neither of two writers succeeded: {codes}")
    state = bench.state(case)
    if state not in ("a", "b"):
        raise Wrong(f"the case of two writers is {state}")
    whole_case(bench, place, "a")
    return f"exit codes {codes[0]} and {codes[1]}"


@fault
def two_sweeps(bench, rng, place):
    """Two or three programs run one study, and one of them may be killed."""
    bench.plan_study(os.path.join(place, "study"))
    run = os.path.join(place, "study/run")
    processes = []
    for _ in range(rng.randint(2, 3)):
        processes.append(bench.start("sweep", "run", run, "--quiet"))
        time.sleep(rng.uniform(0.0, 0.3 * bench.seconds["sweep"]))
    if rng.random() < 0.5:
        strike(processes[0], signal.SIGKILL)
    codes = [bench.finish(process)[0] for process in processes]
    if any(code not in (0, 3, -signal.SIGKILL) for code in codes):
        raise Wrong(f"exit codes {codes}")
    finish_study(bench, place)
    return f"{len(processes)} writers"


def on_full_disk(bench, place, disk, arguments, before, limit=None):
    """Runs a command whose output may not fit; it must then end with exit code 2 and leave the old files unchanged."""
    code, err = bench.run(*arguments, "--quiet", **({} if limit is None else {"limit_bytes": limit}))
    if code == 0:
        return "fits"
    if code != 2:
        raise Wrong(f"exit code {code}: {err.strip()}")
    if "partial" in err:
        raise Wrong(f"the message names a temporary file: {err.strip()}")
    after = {name: None if os.path.isdir(os.path.join(disk, name)) else os.stat(os.path.join(disk, name)).st_size
             for name in names(disk)}
    if after != before:
        raise Wrong(f"the full disk has changed: {sorted(set(after.items()) ^ set(before.items()))}")
    return "refused"


def sizes(folder):
    return {name: None if os.path.isdir(os.path.join(folder, name)) else os.stat(os.path.join(folder, name)).st_size
            for name in names(folder)}


@fault
def full_disk(bench, rng, place):
    """`render`, `correlate` or `compare` on a disk with too little space (a small tmpfs or a file size limit)."""
    disk = os.path.join(place, "disk")
    os.makedirs(disk)
    command = rng.choice(["render", "correlate", "compare"])
    case = os.path.join(disk, "case")
    room = rng.randrange(4, 300) * 1024
    held = 0 if command == "render" else 300 * 1024
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={held + room}", "tmpfs", disk], check=False,
                             stderr=subprocess.DEVNULL).returncode == 0
    try:
        if command != "render":
            shutil.copytree(bench.at("known_a"), case, ignore=shutil.ignore_patterns("*.png"))
        if command == "correlate":
            os.remove(os.path.join(case, "errors.json"))
        arguments = (command, bench.at("a.toml"), "-o", case) if command == "render" else (command, case)
        if mounted:  # leave this much space
            free = os.statvfs(disk).f_bavail * os.statvfs(disk).f_frsize
            with open(os.path.join(disk, "ballast"), "wb") as ballast:
                ballast.write(bytes(max(0, free - room)))
        outcome = on_full_disk(bench, place, disk, arguments, sizes(disk), None if mounted else room)
        if mounted:
            os.remove(os.path.join(disk, "ballast"))
    finally:
        if mounted:
            subprocess.run(["umount", "-l", disk], check=True)
    return f"{command} {outcome}"


@fault
def full_disk_in_sweep(bench, rng, place):
    """A study whose disk fills up, resumed when there is space again."""
    bench.plan_study(os.path.join(place, "study"))
    run = os.path.join(place, "study/run")
    code, err = bench.run("sweep", "run", run, "--quiet", limit_bytes=rng.randrange(0, 12000))
    if code not in (0, 2, 3):
        raise Wrong(f"exit code {code}: {err.strip()}")
    finish_study(bench, place, "--retry-failed")
    return f"run {code}"
