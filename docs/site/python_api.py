"""The page of the Python package's functions and classes, from the docstrings of its source (which is not imported)."""

import ast
import pathlib

Definition = ast.ClassDef | ast.FunctionDef


def public_names(package: pathlib.Path) -> list[str]:
    """Returns `__all__` of a package, without names that start with an underscore."""
    for node in ast.parse((package / "__init__.py").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return [name for name in ast.literal_eval(node.value) if not name.startswith("_")]
    return []


def definitions(package: pathlib.Path) -> dict[str, Definition]:
    """Returns the documented classes and functions at the top of all modules; those of info also as `info.NAME`."""
    found: dict[str, Definition] = {}
    for file in sorted(package.glob("*.py")):
        for node in ast.parse(file.read_text(encoding="utf-8")).body:
            if isinstance(node, Definition) and ast.get_docstring(node) and not node.name.startswith("_"):
                if file.stem == "info":
                    found[f"info.{node.name}"] = node
                found.setdefault(node.name, node)
    return found


def members(node: Definition) -> list[ast.FunctionDef]:
    """Returns the documented methods and properties of a class, with its constructor."""
    functions = [inner for inner in getattr(node, "body", []) if isinstance(inner, ast.FunctionDef)]
    return [inner for inner in functions
            if ast.get_docstring(inner) and (inner.name == "__init__" or not inner.name.startswith("_"))]


def signature(node: Definition, name: str) -> str:
    if isinstance(node, ast.ClassDef):
        return f"class {name}"
    if any(ast.unparse(decorator) in ("property", "cached_property") for decorator in node.decorator_list):
        return name
    arguments = [part for part in ast.unparse(node.args).split(", ") if part not in ("self", "cls")]
    return f"{name}({', '.join(arguments)})"


def entry(node: Definition, name: str) -> list[str]:
    """Returns signature and docstring: one line as text, several lines as they are."""
    text = ast.get_docstring(node)
    lines = [text] if "\n" not in text else ["```text", text, "```"]
    return [f"`{signature(node, name)}`", "", *lines, ""]


def python_api_page(package: pathlib.Path) -> str:
    page = ["# Python functions and classes", "", "[Python](../python.md) shows them at work. Units are in the names: "
            "`_mm`, `_px`. `gs` is the package: `import gladstone as gs`.", ""]
    known = definitions(package)
    names = [name for name in public_names(package) if name in known]
    names += sorted(name for name in known if name.startswith("info.") and name[5:] not in names)
    of_torch = {f"torch.{node.name}": node for node in ast.parse((package / "torch.py").read_text(encoding="utf-8")).body
                if isinstance(node, ast.ClassDef)}
    for heading in [*names, *sorted(of_torch)]:
        node, name = of_torch.get(heading) or known[heading], heading.removeprefix("torch.")
        page += [f"## {heading}", "", *entry(node, name)]
        for inner in members(node) if isinstance(node, ast.ClassDef) else []:
            page += entry(inner, name if inner.name == "__init__" else inner.name)
    return "\n".join(page)
