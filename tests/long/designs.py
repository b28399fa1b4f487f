"""Simulates the recommendations of gladstone design for randomly drawn requirements, with new seeds of dots, rays
and noise. Every requirement must be met within two standard errors, or the design be reported as infeasible, with the reason.

    python3 -B tests/long/designs.py --program build/bin/gladstone [--sets 10] [--first 1] [--seeds 8] [--index N]
"""
import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile

BENCH = """schema = 1
[camera]
pixels = [512, 512]
pixel_pitch_um = 10.0
bit_depth = 12
[camera.noise]
full_well_e = 30000
[lens]
focal_length_mm = 105.0
f_number = 11.0
[geometry]
z_a_mm = {z_a}
z_d_mm = {z_d}
[medium]
thickness_mm = 10.0
[medium.field]
kind = "sinusoid"
amplitude_kg_m3 = 0.064
wavelength_mm = 20.0
[target]
dot_diameter_px = {dot}
[correlate]
window_px = [32, 16]
"""
FREE = {
    "geometry.z_a_mm": [300.0, 2000.0],
    "geometry.z_d_mm": [100.0, 1200.0],
    "target.dot_diameter_mm": [0.1, 2.0],
    "lens.focal_length_mm": [50, 85, 105, 200],
    "lens.f_number": [5.6, 11, 22],
}
OBJECTIVES = ["gradient_min", "resolution", "uncertainty", "z_total"]
FRESH_SEED = 900000


def run(program, arguments, codes=(0,)):
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    if done.returncode not in codes:
        raise RuntimeError(f"gladstone {' '.join(arguments)} ended with {done.returncode}: {done.stderr.strip()}")
    return done.returncode, json.loads(done.stdout)


def question(program, folder, index):
    """Returns a setup with requirements close to the performance of a typical set-up."""
    draw = random.Random(index)
    bench = BENCH.format(z_a=draw.uniform(500, 1500), z_d=draw.uniform(200, 1000), dot=draw.uniform(1.5, 3.5))
    path = os.path.join(folder, "bench.toml")
    with open(path, "w") as file:
        file.write(bench)
    sheet = run(program, ["design", path, "--json", "--quiet"])[1]["sheet"]
    loose = lambda: math.exp(draw.uniform(-0.25, 0.6))
    objective = OBJECTIVES[index % 4]
    view = [size / loose() for size in sheet["field_of_view_mm"]]
    lines = ["[requirements]", f'objective = "{objective}"', f"field_of_view_mm = [{view[0]}, {view[1]}]"]
    if objective != "gradient_min":
        lines.append(f"gradient_min_kg_m4 = {sheet['gradient_min_kg_m4'] * loose()}")
    if objective != "resolution":
        lines.append(f"resolution_mm = {sheet['resolution_mm'] * loose()}")
    return bench + "\n".join(lines)


def with_choices(text, choices):
    """Returns the question with free keys that have these values: an interval, or a list."""
    limits, inventory = ["[limits]", "z_total_max_mm = 3200.0"], ["[inventory]"]
    for key, values in choices.items():
        name = key.split(".")[1]
        if name == "focal_length_mm":
            inventory.append(f"focal_lengths_mm = {values}")
        elif name == "f_number":
            inventory.append(f"f_numbers = {values}")
        elif len(values) == 1:
            limits.append(f"{name} = {{ values = {values} }}")
        else:
            limits.append(f"{name} = {values}")
    free = ["[free]", f"keys = {json.dumps(list(choices))}"]
    return "\n".join([text, *limits, *inventory, *free]) + "\n"


def check(arguments, index):
    """Checks one set of requirements. Returns a line to print, and whether the result is acceptable."""
    with tempfile.TemporaryDirectory() as folder:
        asked = question(arguments.program, folder, index)
        path = os.path.join(folder, "question.toml")
        with open(path, "w") as file:
            file.write(with_choices(asked, FREE))
        code, answer = run(arguments.program, ["design", path, "--json", "--quiet", "--verify", "2"], (0, 4))
        if code == 4:
            reasons = answer["conflicts"] or [
                f"{row['key']} (simulated {row['simulated']:.4g}, required {row['required']:.4g})"
                for bench in answer.get("verification", [])
                for row in bench.get("requirements", []) if not row["kept"]]
            return f"infeasible: {', '.join(dict.fromkeys(reasons)) or 'no reason'}", bool(reasons)
        found = {key: [value] for key, value in answer["recommended"].items()}
        with open(path, "w") as file:
            file.write(with_choices(asked, found))
        fresh = ["--verify", "1", "--repeats", str(arguments.seeds), "--seed", str(FRESH_SEED + index)]
        again = run(arguments.program, ["design", path, "--json", "--quiet", *fresh], (0, 4))[1]
        if not again.get("verification"):
            return f"the recommended set-up does not meet its own requirements: {again['conflicts']}", False
        bench = again["verification"][0]
        if "failed" in bench:
            return f"could not be simulated: {bench['failed']}", False
        told = ", ".join(f"{row['key'].split('.')[1]} {row['simulated']:.4g} +- {row['standard_error']:.2g} for {row['required']:.4g}"
                         for row in bench["requirements"])
        return ("meets " if bench["kept"] else "MISSES ") + told, bench["kept"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--sets", type=int, default=10)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--index", type=int, help="only this set")
    arguments = parser.parse_args()
    indices = [arguments.index] if arguments.index else range(arguments.first, arguments.first + arguments.sets)
    wrong = 0
    for index in indices:
        text, good = check(arguments, index)
        wrong += not good
        print(f"set {index}: {text}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
