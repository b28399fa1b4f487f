#!/usr/bin/env python3
"""Builds the documentation site from the Markdown files of the repository: make docs.

The pages link to each other as files of the repository. They are copied with the same relative paths, together with
the files outside docs/ that they link to, so that all links remain valid. The page of the command line is generated
from the program's --help, that of the Python package from its docstrings.
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys

from python_api import python_api_page

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")


def copy_pages(pages: pathlib.Path) -> None:
    """Copies README.md, docs/ and, page by page, all files that they link to."""
    shutil.rmtree(pages, ignore_errors=True)
    waiting = [ROOT / "README.md", *(path for path in sorted((ROOT / "docs").rglob("*")) if path.is_file())]
    copied = set()
    while waiting:
        source = waiting.pop()
        if source in copied or not source.is_file() or ROOT not in source.parents:
            continue
        copied.add(source)
        target = pages / source.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
        if source.suffix == ".md":
            links = LINK.findall(source.read_text(encoding="utf-8"))
            waiting += [(source.parent / link).resolve() for link in links if "://" not in link]


def help_text(program: str, *words: str) -> str:
    text = subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout
    return text.replace(f"Usage: {program} ", "Usage: gladstone ").strip()


def subcommands(text: str) -> list[str]:
    """Returns the names below "Subcommands:" of a help text."""
    names, inside = [], False
    for line in text.splitlines():
        if inside and (name := re.match(r"  (\S+)", line)):
            names.append(name[1])
        inside = line == "Subcommands:" or (inside and line.startswith("  "))
    return names


def command_line_page(program: str) -> str:
    page = ["# Command line", "", "The output of `gladstone --help` and of `gladstone COMMAND --help`. "
            "[Commands](../commands.md) explains results, exit codes and conventions.", ""]

    def add(*words: str) -> None:
        text = help_text(program, *words)
        title = f"{'###' if len(words) > 1 else '##'} gladstone {' '.join(words)}".rstrip()
        page.extend([title, "", "```", text, "```", ""])
        for name in subcommands(text):
            add(*words, name)

    add()
    return "\n".join(page)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True, help="gladstone, whose --help is printed")
    parser.add_argument("--pages", type=pathlib.Path, default=ROOT / "build/docs/pages", help="folder for the copies")
    parser.add_argument("--site", type=pathlib.Path, default=ROOT / "build/site", help="folder of the site")
    arguments = parser.parse_args()
    copy_pages(arguments.pages)
    reference = arguments.pages / "docs/reference"
    (reference / "command-line.md").write_text(command_line_page(arguments.program), encoding="utf-8")
    (reference / "python-api.md").write_text(python_api_page(ROOT / "python/gladstone"), encoding="utf-8")
    # mkdocs.yml names no folder: that of the copies depends on the build.
    configuration = arguments.pages.parent / "mkdocs.yml"
    configuration.write_text(f"INHERIT: {ROOT / 'mkdocs.yml'}\ndocs_dir: {arguments.pages.resolve()}\n"
                             f"site_dir: {arguments.site.resolve()}\n", encoding="utf-8")
    return subprocess.run([sys.executable, "-m", "mkdocs", "build", "--strict", "--clean", "-f", configuration],
                          check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
