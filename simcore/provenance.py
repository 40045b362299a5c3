"""Which code a result depends on, as a digest that changes when that code does, and only then."""

import ast
import functools
import hashlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def digest(*roots):
    """Digest (16 hex digits) of the given sources and of all of simcore that they import, directly or not.

    roots: paths of Python files or of any other file, relative to the project. Of Python the syntax tree
    counts, so comments, docstrings and layout do not. Imports inside functions count as well.
    """
    found, todo = set(), [ROOT / root for root in roots]
    while todo:
        path = todo.pop()
        if path not in found:
            found.add(path)
            todo.extend(_imports(path) if path.suffix == ".py" else ())
    total = hashlib.sha256()
    for path in sorted(found):
        total.update(f"{path.relative_to(ROOT)}\n{_content(path)}\n".encode())
    return total.hexdigest()[:16]


@functools.cache
def _tree(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and _is_docstring(body[0]):
            del body[0]
    return tree


def _is_docstring(node):
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _content(path):
    return ast.dump(_tree(path)) if path.suffix == ".py" else path.read_text(encoding="utf-8")


@functools.cache
def _imports(path):
    """Files of simcore that the file at `path` imports."""
    package = path.relative_to(ROOT).parent.parts
    files = set()
    for node in ast.walk(_tree(path)):
        if isinstance(node, ast.Import):
            modules = [alias.name.split(".") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = list(package[: len(package) - node.level + 1]) if node.level else []
            module = above + (node.module.split(".") if node.module else [])
            modules = [[*module, alias.name] for alias in node.names]
        else:
            continue
        files.update(filter(None, map(_file, modules)))
    return files


def _file(parts):
    """The file behind a dotted name of simcore: that of its longest part that is a module or package.

    Packages on the way are left out: their __init__ only lists names.
    """
    while parts and parts[0] == "simcore":
        base = ROOT.joinpath(*parts)
        for path in (base.with_suffix(".py"), base / "__init__.py"):
            if path.is_file():
                return path
        parts = parts[:-1]
    return None
