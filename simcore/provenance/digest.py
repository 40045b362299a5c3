"""Digest of the code on which a result depends; it changes if and only if this code changes."""

import ast
import contextlib
import functools
import hashlib
import sys
import tempfile
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from simcore.paths import ROOT, cache_folder, project_file, project_name


def digest(*roots, of=""):
    """Return a digest (16 hex digits) of the given sources and all files of simcore that they import, also indirectly.

    roots: paths of Python files or other files, in the clone or absolute. Python files enter with their syntax tree,
    so that comments, docstrings and layout have no effect. Imports inside functions are followed too. of: further text
    that enters the digest. The digest does not depend on the place where the package is installed. ValueError if a path
    climbs with "..", because it would depend on the working folder.
    """
    for root in roots:
        if ".." in PurePosixPath(root).parts:
            raise ValueError(f"{root}: give the path within the clone, or an absolute path without ..")
    sources, todo = {}, [project_file(root) for root in roots]
    while todo:
        path = todo.pop()
        if path not in sources:
            sources[path] = read_source(path)
            todo.extend(sources[path].imports)
    total = hashlib.sha256(of.encode())
    for path in sorted(sources, key=lambda path: PurePosixPath(project_name(path))):
        total.update(f"{project_name(path)}\n{sources[path].content}\n".encode())
    return total.hexdigest()[:16]


class Source(NamedTuple):
    """The parts of a file that enter a digest."""

    content: str  # digest of the text, or for Python of the syntax tree without docstrings
    imports: frozenset  # paths of the files of simcore that it imports


@functools.cache
def read_source(path: Path) -> Source:
    """Read the file at `path` in the project; the result is cached, because many digests contain the same files."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return Source(_hash(text), frozenset())
    content, *modules = _parse_once(text, path.relative_to(ROOT).parts[:-1] if path.is_relative_to(ROOT) else ())
    return Source(content, frozenset(filter(None, (_file(module.split(".")) for module in modules))))


def _parse_once(text, package):
    """Return the result of `_parse`, from the disk if a process has parsed this text before.

    Parsing the files of a campaign takes 1 s at each start, and reading the stored results 0.1 s. A stored result
    begins with its digest; one that is damaged is replaced.
    """
    name = _hash("\n".join([_OWN_TEXT, sys.version, "/".join(package), text]))
    try:
        path = cache_folder() / "sources" / name[:2] / name
    except RuntimeError:  # there is no home folder
        return _parse(text, package)
    with contextlib.suppress(OSError, UnicodeDecodeError):
        digest_of_rest, _, rest = path.read_text(encoding="utf-8").partition("\n")
        if digest_of_rest == _hash(rest):
            return rest.split("\n")
    parsed = _parse(text, package)
    with contextlib.suppress(OSError):  # without a folder to write to, each process parses the files itself
        _store(path, "\n".join(parsed))
    return parsed


def _store(path, text):
    """Write a text after a line with its digest; other processes and hosts may write the same file at the same time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, own = tempfile.mkstemp(dir=path.parent)
    try:
        with open(handle, "w", encoding="utf-8") as file:
            file.write(f"{_hash(text)}\n{text}")
        Path(own).replace(path)
    finally:
        Path(own).unlink(missing_ok=True)


# Results of another version of this file are not used.
_OWN_TEXT = Path(__file__).read_text(encoding="utf-8")


def _parse(text, package):
    """Return the digest of a Python text, and the dotted names of all modules of simcore that it imports.

    package: the names of the folders in which the file is.
    """
    tree, modules = ast.parse(text), set()
    for node in _with_statements(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and _is_docstring(body[0]):
            del body[0]
        modules.update(_imported(node, package))
    return [_hash(ast.dump(tree)), *sorted(modules)]


def _with_statements(node):
    """Yield a node and all statements in it, but no expressions, which are most of a tree and import nothing."""
    yield node
    for field in ("body", "orelse", "finalbody", "handlers", "cases"):
        inner = getattr(node, field, None)
        if isinstance(inner, list):
            for statement in inner:
                yield from _with_statements(statement)


def _hash(text):
    return hashlib.sha256(text.encode()).hexdigest()


def _is_docstring(node):
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _imported(node, package):
    """Return the dotted names in simcore that a statement imports, which are of modules or of things in them."""
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    elif isinstance(node, ast.ImportFrom):
        above = package[: len(package) - node.level + 1] if node.level else ()
        names = [".".join([*above, *filter(None, [node.module]), alias.name]) for alias in node.names]
    else:
        return ()
    return [name for name in names if name.partition(".")[0] == "simcore"]


def _file(parts):
    """Return the file of a dotted name of simcore: the longest leading part that is a module or package.

    Parent packages are left out, because their __init__ only lists names.
    """
    while parts and parts[0] == "simcore":
        base = ROOT.joinpath(*parts)
        for path in (base.with_suffix(".py"), base / "__init__.py"):
            if path.is_file():
                return path
        parts = parts[:-1]
    return None
