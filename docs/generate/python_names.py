"""Page of the public Python names: their signatures and docstrings."""

import ast
import importlib
import inspect
import re

import simcore
from docs.generate.markdown import table
from simcore.dem.contact.query import ContactQuery

WIDTH = 90  # columns of a signature; a longer one has one argument in a line

_HEAD = """# Python functions

`import simcore` is fast, because each name is imported when it is first used. A packing is an xarray Dataset with the
variables of [its file](packing_file.md). All values are in SI units. (n, 3) is the shape of an array.
"""


def page():
    """Return the page of the public names."""
    parts = [_HEAD]
    for name, (module, attribute) in simcore._PUBLIC.items():
        parts += [f"## simcore.{name} {{#{name}}}", f"```python\n{signature(name, module, attribute)}\n```"]
        parts.append(inspect.getdoc(getattr(simcore, name)))
    parts += ["## Result of a query {#ContactQuery}", inspect.getdoc(ContactQuery), _fields(ContactQuery)]
    return "\n\n".join(parts) + "\n"


def signature(name, module, attribute):
    """Return the signature of a public name as in its source, with the values of constants that are defaults."""
    imported = importlib.import_module(module)
    (node,) = ast.parse(inspect.getsource(getattr(imported, attribute))).body
    arguments = node.args
    for defaults in (arguments.defaults, arguments.kw_defaults):
        for k, default in enumerate(defaults):
            if isinstance(default, ast.Name):
                defaults[k] = ast.Constant(getattr(imported, default.id))
    returned = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    line = f"simcore.{name}({ast.unparse(arguments)}){returned}"
    if len(line) <= WIDTH:
        return line
    listed = re.split(r", (?![^\[(]*[\])])", ast.unparse(arguments))
    return f"simcore.{name}(\n" + "".join(f"    {argument},\n" for argument in listed) + f"){returned}"


def _fields(named_tuple):
    """Return a table of the fields of a NamedTuple, with the comments beside them in its source."""
    fields = re.findall(r"^    (\w+): [^#\n]+# (.+)$", inspect.getsource(named_tuple), re.MULTILINE)
    return table(["field", "meaning"], [[f"`{field}`", comment] for field, comment in fields])
