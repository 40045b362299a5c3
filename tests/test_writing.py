"""A file that cannot be completed leaves the former one."""

import pytest

from simcore.writing import whole_file


def test_a_whole_file_takes_the_place_of_the_former_one(tmp_path):
    path = tmp_path / "bed.txt"
    path.write_text("former")
    with whole_file(path) as part:
        part.write_text("new")
        assert path.read_text() == "former"
    assert path.read_text() == "new" and [each.name for each in tmp_path.iterdir()] == ["bed.txt"]


@pytest.mark.parametrize("error", [OSError("no space"), RuntimeError("NetCDF: no space")])
def test_a_file_that_cannot_be_completed_leaves_the_former_one(tmp_path, error):
    path = tmp_path / "bed.txt"
    path.write_text("former")
    with pytest.raises(OSError, match=r"bed\.txt cannot be written .*no space.* Check that there is free space"):
        with whole_file(path) as part:
            part.write_text("ne")
            raise error
    assert path.read_text() == "former" and [each.name for each in tmp_path.iterdir()] == ["bed.txt"]


def test_another_error_keeps_its_kind(tmp_path):
    with pytest.raises(ValueError, match="wrong"), whole_file(tmp_path / "bed.txt") as part:
        part.write_text("ne")
        raise ValueError("wrong")
    assert not any(tmp_path.iterdir())
