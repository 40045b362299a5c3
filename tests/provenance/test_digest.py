"""The digest of code changes with everything that a result depends on, and with nothing else."""

import pytest

from simcore import paths
from simcore.provenance import digest as provenance


@pytest.fixture
def project(tmp_path, monkeypatch):
    """Return a function that changes a file in a project of modules a -> b -> c and d and returns a's digest."""
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "DATA", tmp_path)
    monkeypatch.setenv("SCREE_CACHE", str(tmp_path / "cache"))
    package = tmp_path / "simcore"
    (package / "deep").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "a.py").write_text("from simcore.deep.b import f\n")
    (package / "deep" / "__init__.py").write_text("from .b import f\n")
    (package / "deep" / "b.py").write_text("def f():\n    from .c import g\n    return g()\n")
    (package / "deep" / "c.py").write_text('def g():\n    """Text."""\n    return 1\n')
    (package / "d.py").write_text("x = 1\n")

    def change(path, text):
        (tmp_path / path).write_text(text)
        provenance.read_source.cache_clear()
        return provenance.digest("simcore/a.py")

    return change


def test_a_change_in_what_is_imported_counts_however_deep(project):
    before = provenance.digest("simcore/a.py")
    assert project("simcore/deep/c.py", "def g():\n    return 2\n") != before


STATEMENTS = {
    "if": "if 1:\n    {}\n",
    "else": "if 1:\n    pass\nelse:\n    {}\n",
    "else of for": "for i in ():\n    pass\nelse:\n    {}\n",
    "with": "with f:\n    {}\n",
    "try": "try:\n    {}\nfinally:\n    pass\n",
    "except": "try:\n    pass\nexcept E:\n    {}\n",
    "finally": "try:\n    pass\nfinally:\n    {}\n",
    "match": "match f:\n    case 1:\n        {}\n",
    "method": "class A:\n    def g(self):\n        {}\n",
}


@pytest.mark.parametrize("text", STATEMENTS.values(), ids=STATEMENTS)
def test_an_import_inside_any_statement_is_followed(project, text):
    before = project("simcore/a.py", text.format("import simcore.d"))
    assert project("simcore/d.py", "x = 2\n") != before


def test_comments_docstrings_and_layout_do_not_count(project):
    before = provenance.digest("simcore/a.py")
    assert project("simcore/deep/c.py", 'def g():\n    """Other."""\n    # why\n    return  1\n') == before


def test_a_text_is_parsed_once_for_all_processes(project, monkeypatch, tmp_path):
    """What a process found in a file is on the disk; another text, or the same in another folder, is not."""
    before = provenance.digest("simcore/a.py")
    monkeypatch.setattr(provenance, "_parse", lambda text, package: ["parsed"])
    text = "from simcore.deep.b import f\n"
    assert project("simcore/a.py", text) == before
    assert project("simcore/a.py", text + "x = 1\n") != before
    (tmp_path / "simcore/deep/d.py").write_text(text)
    assert provenance.read_source(tmp_path / "simcore/deep/d.py").content == "parsed"
    assert provenance.read_source(tmp_path / "simcore/deep/b.py").content != "parsed"


@pytest.mark.parametrize("damage", [b"", b"\xff", None])
def test_a_damaged_file_on_the_disk_is_replaced(project, tmp_path, damage):
    before = provenance.digest("simcore/a.py")
    files = [path for path in (tmp_path / "cache").rglob("*") if path.is_file()]
    contents = {path: path.read_bytes() for path in files}
    assert len(files) == 3
    for path, content in contents.items():
        path.write_bytes(content.rpartition(b"\n")[0] if damage is None else damage)
    provenance.read_source.cache_clear()
    assert provenance.digest("simcore/a.py") == before
    assert {path: path.read_bytes() for path in files} == contents
    assert [path for path in (tmp_path / "cache").rglob("*") if path.is_file()] == files


def test_no_home_folder_is_needed(project, monkeypatch):
    def no_home():
        raise RuntimeError("Could not determine home directory.")

    before = provenance.digest("simcore/a.py")
    monkeypatch.setattr("pathlib.Path.home", no_home)
    provenance.read_source.cache_clear()
    assert provenance.digest("simcore/a.py") == before
    monkeypatch.delenv("SCREE_CACHE")
    provenance.read_source.cache_clear()
    assert provenance.digest("simcore/a.py") == before


def test_no_folder_to_write_to_is_needed(project, monkeypatch, tmp_path):
    before = provenance.digest("simcore/a.py")
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SCREE_CACHE", str(tmp_path / "file"))
    assert project("simcore/a.py", "from simcore.deep.b import f\n") == before


def test_what_is_not_imported_does_not_count(project):
    before = provenance.digest("simcore/a.py")
    assert project("simcore/d.py", "x = 2\n") == before
    assert project("simcore/deep/__init__.py", "y = 2\n") == before


def test_packings_do_not_depend_on_how_they_are_evaluated():
    """The digest of the rule `packing` must not include modules that only evaluate or report."""
    found, todo = set(), [provenance.ROOT / p for p in ("simcore/scene/setup.py", "simcore/packing/process.py")]
    while todo:
        path = todo.pop()
        if path not in found:
            found.add(path)
            todo.extend(provenance.read_source(path).imports)
    names = {path.stem for path in found}
    assert "step" in names
    assert not names & {"porosity", "regression", "evaluate", "studies", "study_tables", "tables", "page"}


def test_a_path_that_depends_on_the_working_folder_is_refused():
    with pytest.raises(ValueError, match=r"\.\./report/page.rst: give the path within the clone"):
        provenance.digest("../report/page.rst")
