#!/usr/bin/env python3
"""Tests of the runner of examples, and of the navigation of the documentation site (mkdocs.yml)."""

import contextlib
import io
import pathlib
import re
import sys
import tempfile
import unittest

import run_blocks

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs/site"))

import build  # noqa: E402
import python_api  # noqa: E402


def run(text: str) -> tuple[int, str]:
    """Runs a page with this text; returns the exit code and what is printed."""
    printed = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(printed):
        page = pathlib.Path(folder, "page.md")
        page.write_text(text, encoding="utf-8")
        code = run_blocks.run_page(page, ROOT, "/bin/true")
    return code, printed.getvalue()


class Runner(unittest.TestCase):
    def test_finds_marked_blocks_with_their_lines(self):
        text = "# T\n\n```\nmake\n```\n\n```sh\ntrue\n```\n```toml\na = 1\n```\n```python\nx = 1\n```\n"
        self.assertEqual(run_blocks.runnable_blocks(text), [(8, "sh", "true\n"), (14, "python", "x = 1\n")])

    def test_writes_blocks_with_a_title(self):
        self.assertEqual(run('```toml title="a.toml"\nx = 1\n```\n```sh\ngrep -qx "x = 1" a.toml\n```\n'), (0, ""))

    def test_runs_the_blocks_of_a_page_in_one_folder(self):
        self.assertEqual(run("```sh\necho 1 > a\nls data/README.md\n```\n```python\nopen('a').read()\n```\n"), (0, ""))

    def test_fails_at_the_first_command_that_fails(self):
        code, printed = run("text\n\n```sh\nfalse\ntrue\n```\n")
        self.assertEqual(code, 1)
        self.assertIn("page.md:4: exit code 1", printed)

    def test_skips_a_page_without_its_python_packages(self):
        code, printed = run("```python\nimport no_such_package_of_python\n```\n```sh\nfalse\n```\n")
        self.assertEqual(code, run_blocks.SKIPPED)
        self.assertIn("no_such_package_of_python", printed)


class Site(unittest.TestCase):
    GENERATED = {"docs/reference/command-line.md", "docs/reference/python-api.md"}

    def test_navigation_contains_every_page_once(self):
        navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("\nnav:\n")[1]
        listed = re.findall(r": (\S+\.md)$", navigation, re.MULTILINE)
        self.assertEqual(len(listed), len(set(listed)))
        pages = {str(path.relative_to(ROOT)) for path in (ROOT / "docs").rglob("*.md")}
        self.assertEqual(pages - set(listed), set())
        self.assertEqual([page for page in listed if not (ROOT / page).is_file() and page not in self.GENERATED], [])

    def test_pages_are_copied_with_the_files_that_they_link_to(self):
        with tempfile.TemporaryDirectory() as folder:
            build.copy_pages(pathlib.Path(folder))
            copied = {str(path.relative_to(folder)) for path in pathlib.Path(folder).rglob("*") if path.is_file()}
        self.assertLessEqual({"README.md", "CONTRIBUTING.md", "data/README.md", "docs/figure4.png"}, copied)
        self.assertFalse([name for name in copied if name.startswith(("render/", "build/"))])

    def test_help_names_the_subcommands(self):
        text = ("Usage\n\nOptions:\n  -h   Help\n\nSubcommands:\n  plan    Write\n          more\n  run     Compute\n"
                "\nExample:\n  run x")
        self.assertEqual(build.subcommands(text), ["plan", "run"])

    def test_python_page_has_every_documented_name(self):
        package = ROOT / "python/gladstone"
        page = python_api.python_api_page(package)
        compiled = {"info", "set_threads", "threads"}       # a module, and functions of the compiled part
        for name in set(python_api.public_names(package)) - compiled:
            self.assertIn(f"\n## {name}\n", page)
        self.assertIn("## torch.RenderedPairs", page)

    def test_start_and_how_to_have_runnable_examples(self):
        for page in [ROOT / "README.md", *(ROOT / "docs/start").glob("*.md"), *(ROOT / "docs/how-to").glob("*.md")]:
            with self.subTest(page=page.name):
                self.assertTrue(run_blocks.runnable_blocks(page.read_text(encoding="utf-8")))

    def test_pages_show_figures_with_captions(self):
        for page in (ROOT / "docs/explained").glob("*.md"):
            with self.subTest(page=page.name):
                self.assertRegex(page.read_text(encoding="utf-8"), r"(?m)^!\[[^]]+\]\([^)]+\.png\)\n\n\*[A-Z]")


if __name__ == "__main__":
    unittest.main()
