"""Runs notebooks from their first cell to their last, each in its own folder: an error of a cell ends the run.

    PYTHONPATH=build/python/site build/python/venv/bin/python -B tests/long/notebooks.py docs/notebooks/*.ipynb

Requires nbclient, nbformat and ipykernel. The files are not changed; those in the repository have no outputs.
"""
import argparse
import os
import sys
import tempfile
import time

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError


def run(path):
    """Returns a line to print, and whether the notebook ran to its end and is stored without outputs."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    if any(cell.get("outputs") for cell in notebook.cells):
        return "has outputs; remove them before it is committed", False
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        try:
            NotebookClient(notebook, timeout=1800, resources={"metadata": {"path": folder}}).execute()
        except CellExecutionError as error:
            return f"failed: {error}", False
    figures = sum("image/png" in output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", []))
    return f"{time.perf_counter() - start:.0f} s, {figures} figures", figures > 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("notebooks", nargs="+")
    wrong = 0
    for path in parser.parse_args().notebooks:
        text, good = run(path)
        wrong += not good
        print(f"{os.path.basename(path)}: {text}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
