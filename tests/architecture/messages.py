"""Lists what the program may tell a user: tests/architecture/messages.txt holds the text of every error and warning of
the sources, and docs/reference/errors.md the codes of errors and warnings. Both are generated, so that a change of a message is seen in
review as a change of one line. Without arguments, compares; with --renew, writes both files.
"""

from __future__ import annotations

import argparse
import difflib
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LIST = "tests/architecture/messages.txt"
CODES = "docs/reference/errors.md"
ROOMS = ("render", "analysis", "studies", "cuda", "python/src")
TABLE_HEAD = "| code | meaning |\n|---|---|\n"

# Calls that report to the user, and their codes if the call names none; "-" means that the code is chosen elsewhere.
CALLS = re.compile(
    r"\b(?:(?P<data>DataError)|(?P<output>OutputError)|(?P<device>DeviceError|OutOfDeviceMemory)"
    r"|(?P<interrupted>Interrupted)|(?P<other>refuse|refuse_open|reject_nodes|fail|add_problem|Words)"
    r"|(?P<slurm>SlurmError)|(?P<experiment>require_experiment)"
    r"|(?P<problem>problem_?|SetupProblem|SetupError|(?<=problems\.)push_back|(?<=problems_\.)push_back)"
    r"|(?P<warning>warn|log_warning|note_once|(?<=return )Warning|(?<=warnings\.)push_back|(?<=warnings_\.)push_back"
    r"|(?<=notes\.)push_back|(?<=notes_\.)push_back))\s*[({]"
)
DEFAULT_CODE = {
    "data": "-", "output": "output", "device": "device", "interrupted": "interrupted", "other": "-",
    "slurm": "arguments", "experiment": "wrong_format", "problem": "invalid_value", "warning": "warning",
}  # fmt: skip
TOKEN = re.compile(
    r"//[^\n]*|/\*.*?\*/"
    r'|R"(?P<mark>[^(\s]*)\((?P<raw>.*?)\)(?P=mark)"'
    r'|"(?P<text>(?:[^"\\\n]|\\.)*)"'
    r"|(?<!\w)'(?:[^'\\\n]|\\.)+'"
    r"|(?P<open>[({\[])|(?P<close>[)}\]])|(?P<end>;)",
    re.DOTALL,
)
# Functions that return a problem as a text, which others report, or a key and its problem.
TEXT_FUNCTIONS = re.compile(
    r"std::(?:string|pair<std::string, std::string>) "
    r"(?:\w+::)?(?:\w*(?:problem|reason|fault|refusal|warning|caveat|mistake|shortage)\w*"
    r"|broken_\w+|wrong_\w+|beyond_\w+|describe_(?:factor|offset|shift)|(?:uncorrelated|failed)_text)\("
)
RETURN = re.compile(r"\breturn\b")
# Assignments of a problem to a member that others report.
ASSIGNMENT = re.compile(r"\.problem = ")
# Members of tables that are reported as problems.
REASONS = re.compile(r"\.reason_\w+ = \"([^\"]+)\"")
ESCAPES = {r"\"": '"', r"\n": " ", r"\\": "\\"}


def without_comments(source: str) -> str:
    """Replaces comments by blanks."""
    return TOKEN.sub(lambda token: " " if token[0].startswith(("//", "/*")) else token[0], source)


def read_until(source: str, begin: int, *, statement: bool = False) -> tuple[str, str]:
    """Reads from behind an opening bracket to its closing one, or from a word to the end of its statement.

    Returns the code, and the text of its string literals: literals that follow each other are joined, and "..."
    represents the code between others.
    """
    depth, at, text = 0 if statement else 1, begin, ""
    for token in TOKEN.finditer(source, begin):
        depth += bool(token["open"]) - bool(token["close"])
        if depth < 0 or (token["end"] if statement else token["close"]) and depth == 0:
            return source[begin : token.start()], text
        literal = token["raw"] if token["raw"] is not None else token["text"]
        if literal is None:
            continue
        between = source[at : token.start()].strip()
        literal = re.sub(r'\\["n\\]', lambda escape: ESCAPES[escape[0]], literal)
        text += ("..." if between and text else "") + literal
        at = token.end()
    return source[begin:], text


def returned_texts(source: str) -> list[str]:
    """Returns the texts that functions return as problems."""
    texts = []
    for function in TEXT_FUNCTIONS.finditer(source):
        parameters, _ = read_until(source, function.end())
        body = re.compile(r"\)[\w\s]*\{").match(source, function.end() + len(parameters))
        if body:
            code, _ = read_until(source, body.end())
            texts += [read_until(code, statement.end(), statement=True)[1] for statement in RETURN.finditer(code)]
    return texts


def messages(source: str) -> list[str]:
    """Returns the messages of a source, "code: text", sorted."""
    source = without_comments(source)
    found = {f"-: {' '.join(text.split())}" for text in returned_texts(source) if " " in text.strip()}
    found |= {f"-: {text}" for text in REASONS.findall(source)}
    assigned = [read_until(source, begin.end(), statement=True)[1] for begin in ASSIGNMENT.finditer(source)]
    found |= {f"-: {' '.join(text.split())}" for text in assigned if text}
    for call in CALLS.finditer(source):
        arguments, text = read_until(source, call.end())
        if " " not in text.strip():
            continue  # the text is made elsewhere, or the call is a declaration
        code = re.search(r"(Error|Warning)Code::(\w+)", arguments)
        name = ("warning " if code[1] == "Warning" else "") + code[2] if code else DEFAULT_CODE[call.lastgroup]
        found.add(f"{name}: {' '.join(text.split())}")
    return sorted(found)


def all_messages() -> str:
    """Returns the content of the list: the messages of each file, below its name."""
    parts = []
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*")):
            if path.suffix in {".h", ".cpp", ".cu", ".cuh"} and (lines := messages(path.read_text())):
                parts.append("\n".join([path.relative_to(ROOT).as_posix(), *(f"  {line}" for line in lines)]))
    return "\n\n".join(parts) + "\n"


def code_table(kind: str) -> str:
    """Returns the table of the codes of "error" or "warning", from the comments of the enumeration."""
    header = (ROOT / f"render/base/{kind}.h").read_text()
    enumeration = header[header.index(f"enum class {kind.title()}Code") :]
    enumeration = enumeration[: enumeration.index("};")]
    rows = re.findall(r"^\s*(\w+),\s*///< (.*)$", enumeration, re.MULTILINE)
    return TABLE_HEAD + "".join(f"| `{name}` | {meaning} |\n" for name, meaning in rows)


def with_tables(page: str) -> str:
    """Returns a page with its tables of codes, those of errors first, replaced by the present ones."""
    end = 0
    for kind in ("error", "warning"):
        start = page.index(TABLE_HEAD, end)
        table = code_table(kind)
        page = page[:start] + table + page[page.index("\n\n", start) + 1 :]
        end = start + len(table)
    return page


def self_test() -> None:
    """Checks that the list does not depend on the layout of the source."""
    one_line = 'throw DataError(ErrorCode::damaged, path, "is \\"cut\\" short; copy it");  // warn("not a call")'
    wrapped = 'throw DataError(\n  ErrorCode::damaged, path,\n  "is \\"cut\\" "\n  "short; copy it");'
    assert messages(one_line) == messages(wrapped) == ['damaged: is "cut" short; copy it'], messages(wrapped)
    joined = 'table.problem("key", "is " + f(")", 1) + " m long", ErrorCode::out_of_range); warn("a {}" " b", c);'
    assert messages(joined) == ["out_of_range: key...is ...)... m long", "warning: a {} b"], messages(joined)
    warned = 'warn(all, {WarningCode::ignored, "lens.file", f("line {} is " "not used", n)});'
    assert messages(warned) == ["warning ignored: lens.file...line {} is not used"], messages(warned)
    assert messages('DataError(ErrorCode code, std::string const& file) {}; OutputError(p, "is a file");') == [
        "output: is a file"
    ]
    returned = 'std::string window_problem(int n) {\n  if (n > 1) return f("{} is; " "too large", n);\n  return "";\n}'
    assert messages(returned) == ["-: {} is; too large"], messages(returned)
    for source, message in (
        ('throw SetupError({SetupProblem{"axis", f("expected {}", 1)}});', "invalid_value: axis...expected {}"),
        ('throw SetupError({{path, "is empty; fill it", key, ErrorCode::syntax}});', "syntax: is empty; fill it"),
        ('  problem(place, "has an \\"x\\"; remove it");', 'invalid_value: has an "x"; remove it'),
        ('problem_(place, "is a table");', "invalid_value: is a table"),
        ('reject_nodes(map, [&](int i) { return i > 1; }, "is infinite", "crop it");', "-: is infinite...crop it"),
        ('refuse_open("too few dots");', "-: too few dots"),
        ('throw SlurmError("no such job: " + id);', "arguments: no such job:"),
        ('std::array all{Words{Kind::masked, "masked", "is masked"}};', "-: masked...is masked"),
        ('std::string describe_factor(Vec2d f) {\n  return f("u is {} times", f.x);\n}', "-: u is {} times"),
        ('std::string uncorrelated_text(int n) {\n  return "differ; use others";\n}', "-: differ; use others"),
        ('std::pair<std::string, std::string> beyond_design(Setup s) {\n  return {"lens", "is tilted"};\n}',
         "-: lens...is tilted"),
        ('pair.problem = a ? f("{} has no partner", b) : "";', "-: {} has no partner..."),
    ):  # fmt: skip
        assert messages(source) == [message], (messages(source), message)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--renew", action="store_true", help="write both files instead of comparing them")
    renew = parser.parse_args().renew
    self_test()
    outdated = 0
    page = (ROOT / CODES).read_text()
    for name, content in ((LIST, all_messages()), (CODES, with_tables(page))):
        path = ROOT / name
        stored = path.read_text() if path.exists() else ""
        if renew:
            path.write_text(content)
        elif stored != content:
            outdated += 1
            sys.stdout.writelines(difflib.unified_diff(
                stored.splitlines(True), content.splitlines(True), name, "sources", n=0))  # fmt: skip
    if outdated:
        print("Read the changed texts as a user would; then run: python3 tests/architecture/messages.py --renew")
    return 1 if outdated else 0


if __name__ == "__main__":
    sys.exit(main())
