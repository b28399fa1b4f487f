#!/usr/bin/env python3
"""Disturbs the program at random moments and checks the resulting files: make soak, docs/reliability.md."""

import argparse
import collections
import os
import random
import shutil
import sys
import tempfile
import time

import commands  # noqa: F401  (adds its faults to ALL)
from bench import Bench, Wrong
from faults import ALL


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--program", default="build/bin/gladstone")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--runs", type=int, default=300)
    options.add_argument("--only", choices=sorted(ALL), action="append", help="only these faults")
    options.add_argument("--index", type=int, help="only this run, to repeat a failure")
    options = options.parse_args()
    chosen = [ALL[name] for name in ALL if not options.only or name in options.only]
    work = tempfile.mkdtemp(prefix="gladstone_soak_")
    outcomes = {function.__name__: collections.Counter() for function in chosen}
    failures = []
    start = time.monotonic()
    try:
        bench = Bench(options.program, os.path.join(work, "bench"))
        for index in range(options.runs) if options.index is None else [options.index]:
            rng = random.Random(f"{options.seed}/{index}")
            function = chosen[index % len(chosen)]
            place = os.path.join(work, "place")
            os.makedirs(place)
            try:
                outcomes[function.__name__][function(bench, rng, place)] += 1
            except Wrong as wrong:
                outcomes[function.__name__]["WRONG"] += 1
                failures.append((index, function.__name__, str(wrong)))
                print(f"run {index}, {function.__name__}: {wrong}", file=sys.stderr)
            shutil.rmtree(place)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    print("| fault | runs | wrong | how they ended |\n|---|---|---|---|")
    for function in chosen:
        ends = outcomes[function.__name__]
        told = ", ".join(f"{ends[end]} {end}" for end in sorted(ends) if end != "WRONG")
        print(f"| {function.__doc__.strip().rstrip('.')} | {sum(ends.values())} | {ends['WRONG']} | {told} |")
    total = sum(sum(ends.values()) for ends in outcomes.values())
    print(f"\nseed {options.seed}: {total} runs, {len(failures)} wrong, {time.monotonic() - start:.0f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
