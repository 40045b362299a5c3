"""Page of the public Python names: their signatures and docstrings."""

import ast
import importlib
import inspect
import re

import simcore
from docs.generate.markdown import table
from simcore.dem.contact.query import ContactQuery
from simcore.dem.simulation import SystemEnergy
from simcore.dem.state.touching_contacts import TouchingContacts

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
        value = getattr(simcore, name)
        parts += [inspect.getdoc(value), *(_members(value) if inspect.isclass(value) else [])]
    parts += ["## Result of a query {#ContactQuery}", inspect.getdoc(ContactQuery), _fields(ContactQuery)]
    parts += [
        "## Contacts of a simulation {#TouchingContacts}",
        inspect.getdoc(TouchingContacts),
        _fields(TouchingContacts),
    ]
    parts += ["## Energy of a simulation {#SystemEnergy}", inspect.getdoc(SystemEnergy), _fields(SystemEnergy)]
    return "\n\n".join(parts) + "\n"


def signature(name, module, attribute):
    """Return the signature of a public name as in its source, with the values of constants that are defaults."""
    imported = importlib.import_module(module)
    (node,) = ast.parse(inspect.getsource(getattr(imported, attribute))).body
    if isinstance(node, ast.ClassDef):
        (node,) = (part for part in node.body if isinstance(part, ast.FunctionDef) and part.name == "__init__")
        del node.args.args[0]  # self
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


def _members(kind):
    """Return the docstring of the constructor of a class, and a table of its public methods and properties."""
    rows = []
    for name, member in vars(kind).items():
        if name.startswith("_"):
            continue
        written = name if isinstance(member, property) else f"{name}{inspect.signature(member)}".replace("(self, ", "(")
        text = inspect.getdoc(member.fget if isinstance(member, property) else member)
        rows.append([f"`{written}`", " ".join(text.split())])
    return [inspect.getdoc(kind.__init__), table(["attribute", "meaning"], rows)]


def _fields(named_tuple):
    """Return a table of the fields of a NamedTuple, with the comments beside them in its source."""
    fields = re.findall(r"^    (\w+): [^#\n]+# (.+)$", inspect.getsource(named_tuple), re.MULTILINE)
    return table(["field", "meaning"], [[f"`{field}`", comment] for field, comment in fields])
