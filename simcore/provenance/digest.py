"""Which code a result depends on, as a digest that changes when that code does, and only then."""

import ast
import functools
import hashlib
from pathlib import Path
from typing import NamedTuple

from simcore.paths import ROOT


def digest(*roots, of=""):
    """Digest (16 hex digits) of the given sources and of all of simcore that they import, directly or not.

    roots: paths of Python files or of any other file, relative to the project or absolute. Of Python the syntax tree
    counts, so comments, docstrings and layout do not. Imports inside functions count as well. of: text that counts too.
    """
    found, todo = {}, [ROOT / root for root in roots]
    while todo:
        path = todo.pop()
        if path not in found:
            found[path] = read_source(path)
            todo.extend(found[path].imports)
    total = hashlib.sha256(of.encode())
    for path in sorted(found):
        total.update(f"{path.relative_to(ROOT)}\n{found[path].content}\n".encode())
    return total.hexdigest()[:16]


class Source(NamedTuple):
    """A file as digests see it."""

    content: str  # digest of the text; of Python that of its syntax tree without docstrings
    imports: frozenset  # paths of simcore's files that it imports


@functools.cache
def read_source(path: Path) -> Source:
    """The file at `path`, which lies in the project; read once, for many digests hold the same files."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return Source(_hash(text), frozenset())
    tree, imports = ast.parse(text), set()
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and _is_docstring(body[0]):
            del body[0]
        imports.update(_imported(node, path))
    return Source(_hash(ast.dump(tree)), frozenset(imports))


def _hash(text):
    return hashlib.sha256(text.encode()).hexdigest()


def _is_docstring(node):
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _imported(node, path):
    """Files of simcore that a statement of the file at `path` imports."""
    if isinstance(node, ast.Import):
        modules = [alias.name.split(".") for alias in node.names]
    elif isinstance(node, ast.ImportFrom):
        package = path.relative_to(ROOT).parent.parts
        above = list(package[: len(package) - node.level + 1]) if node.level else []
        module = above + (node.module.split(".") if node.module else [])
        modules = [[*module, alias.name] for alias in node.names]
    else:
        return ()
    return filter(None, map(_file, modules))


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
