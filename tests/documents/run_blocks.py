#!/usr/bin/env python3
"""Runs the examples of a page: every block marked sh or python, in their order, in one temporary folder. A block with a
title, ```toml title="setup.toml", is written to the file of that name instead.

The folder contains links to studies/ and data/, as the root of the repository does. A Python block whose packages are
missing ends the test as skipped (77), unless an earlier block has failed.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SKIPPED = 77


def runnable_blocks(text: str) -> list[tuple[int, str, str]]:
    """Returns line number, language (sh, python, or "file NAME") and content of the blocks of a page that are run or
    written."""
    blocks = []
    for match in re.finditer(r"^```(\S*)([^\n]*)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
        title = re.search(r'title="([^"/]+)"', match[2])
        language = f"file {title[1]}" if title else match[1]
        if title or language in ("sh", "python"):
            blocks.append((text.count("\n", 0, match.start()) + 2, language, match[3]))
    return blocks


def package_environment(source: pathlib.Path) -> tuple[str, dict[str, str]]:
    """Returns interpreter and environment for Python blocks: those of `make python`, if it was run."""
    python, site = source / "build/python/venv/bin/python", source / "build/python/site"
    environment = dict(os.environ, MPLBACKEND="agg")
    if not python.exists() or not site.exists():
        return sys.executable, environment
    return str(python), environment | {"PYTHONPATH": str(site)}


def missing_packages(code: str, python: str, folder: str, environment: dict[str, str]) -> list[str]:
    packages = sorted(set(re.findall(r"^\s*(?:import|from) (\w+)", code, re.MULTILINE)))
    return [package for package in packages if subprocess.run(
        [python, "-c", f"import {package}"], cwd=folder, env=environment, capture_output=True, check=False).returncode]


def run_page(page: pathlib.Path, source: pathlib.Path, program: str) -> int:
    python, environment = package_environment(source)
    environment["PATH"] = os.pathsep.join([os.path.dirname(os.path.abspath(program)), environment["PATH"]])
    with tempfile.TemporaryDirectory(prefix="page_", dir=os.environ.get("TEST_TMPDIR")) as folder:
        for name in ("studies", "data"):
            os.symlink(source / name, os.path.join(folder, name))
        for line, language, code in runnable_blocks(page.read_text(encoding="utf-8")):
            if language.startswith("file "):
                pathlib.Path(folder, language.removeprefix("file ")).write_text(code, encoding="utf-8")
                continue
            if language == "python" and (missing := missing_packages(code, python, folder, environment)):
                print(f"{page}:{line}: skipped, Python packages are missing: {', '.join(missing)}")
                return SKIPPED
            shell = ["bash", "-e", "-u", "-o", "pipefail"]
            command = [*([python] if language == "python" else shell), "-c", code]
            result = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE,
                                    stderr=subprocess.STDOUT, text=True, check=False)
            if result.returncode:
                print(f"{page}:{line}: exit code {result.returncode}\n{code}\n{result.stdout}")
                return 1
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--source", type=pathlib.Path, required=True, help="root of the repository")
    parser.add_argument("--program", required=True, help="gladstone")
    arguments = parser.parse_args()
    return run_page(arguments.page, arguments.source.resolve(), arguments.program)


if __name__ == "__main__":
    sys.exit(main())
