"""No picture of the documentation is older than the rows or scripts that it shows."""

import pytest

from docs.generate import pictures


def test_every_picture_is_in_the_manifest():
    drawn = {path.relative_to(pictures.DOCS).as_posix() for path in pictures.DOCS.rglob("*.png")}
    assert drawn == set(pictures.manifest()), "correct docs/generate/pictures.yaml"


def test_no_picture_is_older_than_what_it_shows():
    assert pictures.outdated() == [], "draw them again: python -m docs.generate.pictures NAME.png"


def test_every_picture_can_be_drawn_or_says_how():
    entries, drawn = pictures.manifest(), pictures.drawn()
    ways = {name: ("command" in entry) + ("by_hand" in entry) + (name in drawn) for name, entry in entries.items()}
    assert set(ways.values()) == {1}, ways


@pytest.fixture
def rows(tmp_path, monkeypatch):
    """Write a manifest of one picture in a temporary folder and return the path of the rows that it shows."""
    path = tmp_path / "rows.csv"
    path.write_text("n\n0.4\n")
    monkeypatch.setattr(pictures, "MANIFEST", tmp_path / "pictures.yaml")
    (tmp_path / "pictures.yaml").write_text(f"a.png:\n  sources: [{path}]\n  digest: ''\n  by_hand: draw it.\n")
    return path


def test_a_picture_is_older_once_its_rows_change(rows):
    assert pictures.outdated() == ["a.png"]
    pictures.keep("a.png")
    assert pictures.outdated() == []
    rows.write_text("n\n0.5\n")
    assert pictures.outdated() == ["a.png"]


def test_the_command_lists_older_pictures(rows, capsys):
    assert pictures.main([]) == 1
    assert "a.png is older than what it shows" in capsys.readouterr().out
    assert pictures.main(["--keep", "a.png"]) == 0 and pictures.main([]) == 0


def test_a_picture_without_an_entry_is_refused(rows, capsys):
    with pytest.raises(SystemExit):
        pictures.main(["other.png"])
    assert "there is no such picture in pictures.yaml" in capsys.readouterr().err
