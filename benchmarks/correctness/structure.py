"""Print the structure of simcore in numbers, from the syntax trees of a checkout.

    python -m benchmarks.correctness.structure [CHECKOUT]

The numbers are: modules at the root of simcore/, imports between its packages and whether they run one way, functions
with more than eight positional arguments, and files with more than 400 lines. A module at the root counts as a package
of its own. Imports inside functions count as others do. No module of the checkout is run.
"""

import argparse
import ast
from collections import Counter
from pathlib import Path

from simcore.paths import ROOT

MOST_ARGUMENTS = 8
MOST_LINES = 400


def modules(checkout: Path) -> dict[str, Path]:
    """Return the files of simcore in a checkout by dotted name; ValueError if there are none."""
    files = sorted((checkout / "simcore").rglob("*.py"))
    if not files:
        raise ValueError(f"{checkout} has no Python files in a folder simcore/. Name the root of a checkout.")
    return {
        ".".join(file.relative_to(checkout).with_suffix("").parts).removesuffix(".__init__"): file for file in files
    }


def package_of(module: str) -> str:
    """Return the package of simcore that a module belongs to, or its own name if it is at the root."""
    return (module.split(".") + [""])[1]


def syntax_tree(file: Path) -> ast.Module:
    """Parse a file."""
    return ast.parse(file.read_text(encoding="utf-8"), str(file))


def imported_modules(name: str, tree: ast.Module, known) -> set[str]:
    """Return the modules of simcore that a module imports. known: all their names."""
    imported = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            candidates = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                base = ".".join(filter(None, (*name.split(".")[: -node.level], base)))
            # What is imported from a package is either a module of it or a name that its __init__ defines.
            candidates = [inner if (inner := f"{base}.{alias.name}") in known else base for alias in node.names]
        else:
            continue
        imported.update(candidate for candidate in candidates if candidate in known)
    return imported - {name}


def package_imports(checkout: Path) -> Counter:
    """Return how many modules of a package import modules of another: {(package, imported package): number}."""
    files = modules(checkout)
    pairs = Counter()
    for name, file in files.items():
        imported = {package_of(other) for other in imported_modules(name, syntax_tree(file), files)}
        # The root's __init__ names what is public, and whoever imports a package imports it too.
        if name == "simcore":
            continue
        pairs.update((package_of(name), other) for other in imported - {package_of(name), ""})
    return pairs


def cycles(pairs) -> list[list[str]]:
    """Return the groups of packages that import each other, directly or by way of others, each sorted."""
    reached = {package: _reached(package, pairs) for pair in pairs for package in pair}
    groups = {
        tuple(sorted(other for other in reached[package] if package in reached[other]))
        for package in reached
        if package in reached[package]
    }
    return [list(group) for group in sorted(groups)]


def _reached(package: str, pairs) -> set[str]:
    """Return the packages that a package imports, directly or by way of others."""
    reached, waiting = set(), [package]
    while waiting:
        here = waiting.pop()
        new = {other for importer, other in pairs if importer == here} - reached
        reached |= new
        waiting += new
    return reached


def order(pairs) -> list[str]:
    """Return the packages so that each imports only earlier ones; there must be no cycles."""
    packages = {package for pair in pairs for package in pair}
    return sorted(packages, key=lambda package: (len(_reached(package, pairs)), package))


def root_modules(checkout: Path) -> list[str]:
    """Return the modules that are files in simcore/ itself."""
    return sorted(file.stem for file in (checkout / "simcore").glob("*.py"))


def long_files(checkout: Path) -> dict[str, int]:
    """Return the modules with more than MOST_LINES lines, and how many they have."""
    lines = {name: len(file.read_text(encoding="utf-8").splitlines()) for name, file in modules(checkout).items()}
    return {name: count for name, count in lines.items() if count > MOST_LINES}


def long_signatures(checkout: Path) -> dict[str, int]:
    """Return the functions with more than MOST_ARGUMENTS positional arguments, and how many they have.

    Names are dotted, with the enclosing functions and classes. The self of a method does not count.
    """
    counts = {}
    for name, file in modules(checkout).items():
        counts.update(_positional(syntax_tree(file), name))
    return {name: count for name, count in counts.items() if count > MOST_ARGUMENTS}


def _positional(parent: ast.AST, path: str) -> dict[str, int]:
    """Return the number of positional arguments of all functions in a syntax tree, by dotted name."""
    counts = {}
    for node in ast.iter_child_nodes(parent):
        inner = path
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            inner = f"{path}.{node.name}"
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            arguments = [argument.arg for argument in (*node.args.posonlyargs, *node.args.args)]
            bound = isinstance(parent, ast.ClassDef) and arguments[:1] in (["self"], ["cls"])
            counts[inner] = len(arguments) - bound
        counts.update(_positional(node, inner))
    return counts


def report(checkout: Path) -> str:
    """Return all numbers of a checkout as text."""
    root, pairs = root_modules(checkout), package_imports(checkout)
    circles, signatures, files = cycles(pairs), long_signatures(checkout), long_files(checkout)
    lines = [f"Modules at the root of simcore/: {len(root)}", f"  {', '.join(root)}"]
    lines += ["", "Imports between packages, with the number of modules that import:"]
    for package in order(pairs):
        row = [f"{other} {count}" for (importer, other), count in sorted(pairs.items()) if importer == package]
        lines.append(f"  {package}: {', '.join(row) or 'none'}")
    lines += ["", f"Circles of packages: {len(circles)}{'' if circles else ', imports run one way'}"]
    lines += [f"  {', '.join(circle)}" for circle in circles]
    lines += ["", f"Functions with more than {MOST_ARGUMENTS} positional arguments: {len(signatures)}"]
    lines += [f"  {name}: {count}" for name, count in sorted(signatures.items(), key=lambda item: (-item[1], item[0]))]
    lines += ["", f"Files with more than {MOST_LINES} lines: {len(files)}"]
    lines += [f"  {name}: {count}" for name, count in sorted(files.items())]
    return "\n".join(lines)


def main(arguments=None) -> None:
    """Print the numbers of a checkout."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkout", type=Path, nargs="?", default=ROOT, help="root of a checkout; by default this one")
    options = parser.parse_args(arguments)
    try:
        print(report(options.checkout))
    except ValueError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
