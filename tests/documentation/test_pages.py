"""The reference pages are complete: a sentence for each key, option, table, column and public function."""

import ast
import importlib
import re

import pytest

import simcore
from docs.generate import columns, commands, results, settings
from docs.generate.markdown import sentence
from docs.generate.pages import pages
from simcore.paths import ROOT
from simcore.reference.columns.column import Column
from simcore.scene.specification import read_schema
from tests.helpers.few_spheres import FEW_SPHERES

PAGES = pages()


@pytest.mark.parametrize("name", ["packing", "config"])
def test_every_key_of_a_schema_has_a_sentence(name):
    listed = settings.settings(read_schema(name))
    assert len(listed) > 20
    bad = [s.path for s in listed if not _is_sentence(s.node.get("description", ""))]
    assert bad == [], "write a sentence in `description`, with a capital letter and a full stop"


def test_a_description_that_is_no_sentence_is_reported():
    assert _is_sentence("Period T_s.") and _is_sentence('"synthetic" (built in), or a file.')
    assert not _is_sentence("") and not _is_sentence("period") and not _is_sentence("The period")


@pytest.mark.parametrize(("name", "page"), [("packing", "packing_settings"), ("config", "campaign_settings")])
def test_the_page_of_the_settings_has_every_key_with_its_bounds_and_default(name, page):
    text = PAGES[f"reference/{page}.md"]
    listed = settings.settings(read_schema(name))
    assert re.findall(r"\{#([^}]+)\}", text) == [setting.path for setting in listed]
    assert "more than 0 m, at most 100 m; required" in PAGES["reference/packing_settings.md"]  # domain.width
    assert "a time [s], more than 0 s, at most 1 s; default `2e-4 s`" in PAGES["reference/packing_settings.md"]


def test_every_command_and_option_has_a_meaning():
    for name, (parser, line) in commands.parsers().items():
        assert line, name
        bad = [action.dest for action in commands.options(parser) if not action.help]
        assert bad == [], name


def test_the_page_of_the_commands_has_every_option():
    text = PAGES["reference/commands.md"]
    for name, (parser, _) in commands.parsers().items():
        _, _, after = text.partition(f"\n## {name}\n")
        section = after.split("\n## ")[0]
        for action in commands.options(parser):
            assert all(f"`{option}" in section for option in action.option_strings), (name, action.option_strings)


def test_every_public_function_has_a_docstring():
    bad = []
    for path in sorted((ROOT / "simcore").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        bad += [f"{path.relative_to(ROOT)}: {name}" for name in _undocumented(tree)]
    assert bad == []


def test_a_function_without_a_docstring_is_reported():
    tree = ast.parse("class A:\n    '''A.'''\n    def f(self): pass\n    def _g(self): pass\ndef h():\n    '''H.'''\n")
    assert list(_undocumented(tree)) == ["A.f"]


def test_the_page_of_the_python_functions_has_every_public_name():
    text = PAGES["reference/python.md"]
    assert [name for name in simcore._PUBLIC if f"## simcore.{name} " not in text] == []
    assert "simcore.porosity(packing, method='spheres', cut=None, slice_height=None)" in text
    assert "bearing_contacts=" in text and "=BEARING_CONTACTS" not in text


def test_a_sentence_keeps_symbols_and_names():
    assert sentence("length of the bed") == "Length of the bed."
    assert sentence("a mean") == "A mean." and sentence("n minus r22_n") == "n minus r22_n."
    assert sentence("netCDF file") == "netCDF file." and sentence("n_std_error of it") == "n_std_error of it."


def test_every_group_of_columns_is_on_the_page():
    listed = {id(group) for group in columns.groups().values()}
    for module in {module for module, _, _ in columns.GROUPS}:
        for name, value in vars(importlib.import_module(f"simcore.reference.columns.{module}")).items():
            if name.isupper() and not name.startswith("_") and isinstance(value, tuple):
                assert id(value) in listed or not isinstance(value[0], Column), f"add {module}.{name} to GROUPS"


def test_every_committed_table_has_a_sentence():
    assert set(results.committed_tables()) == set(results.sentences()), "correct docs/generate/results.yaml"
    assert [path for path, entry in results.sentences().items() if not entry.get("what")] == []


def test_every_column_of_a_committed_table_is_on_the_page_of_results():
    text = PAGES["reference/results.md"]
    part = text.split("### single_form.csv")[1].split("### ")[0]
    rows = [re.findall(r"`([^`]*)`", line)[0] for line in part.splitlines() if line.startswith("    | `")]
    header = (results.REFERENCE / "single_form.csv").read_text().split("\n")[0].split(",")
    assert rows == header


def test_the_page_of_the_file_lists_every_variable_and_attribute_of_a_packing():
    bed = simcore.pack(FEW_SPHERES, force=True)
    text = (ROOT / "docs" / "reference" / "packing_file.md").read_text(encoding="utf-8")
    listed = dict(re.findall(r"^\| `(\w+)` \| ([\w, ]+ \| [^|]*)\|", text, re.MULTILINE))
    expected = {
        name: f"{', '.join(variable.dims)} | {variable.attrs.get('units', '')}"
        for name, variable in bed.variables.items()
    }
    assert {name: cell.strip() for name, cell in listed.items()} == {name: e.strip() for name, e in expected.items()}
    attributes = text.split("## Attributes")[1]
    assert [name for name in bed.attrs if f"`{name}`" not in attributes] == []


def _is_sentence(text):
    text = text.strip()
    return bool(re.match(r"[A-Z\"']", text)) and text.endswith(".") and len(text.split()) > 1


def _undocumented(tree, above=""):
    """Yield the public functions, methods and classes of a syntax tree that have no docstring."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            if not ast.get_docstring(node):
                yield f"{above}{node.name}"
            if isinstance(node, ast.ClassDef):
                yield from _undocumented(node, f"{above}{node.name}.")
