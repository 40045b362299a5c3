"""Reading of the options and paths of commands."""

import os

import pytest

from simcore.commands.options import check_writable, cut_length, duration, grain_size, length


def test_lengths_are_metres_or_quantities_with_a_point_or_a_comma():
    assert length("--cut", None) is None
    assert length("--cut", "0.008") == length("--cut", "8 mm") == length("--cut", "0,8 cm") == length("--cut", "0,008")
    assert grain_size("--finest", "0,5 mm") == 0.0005
    assert duration("--frames", "0.1 s") == duration("--frames", "100 ms") == 0.1


def test_a_cut_may_be_zero():
    assert cut_length("0 mm") == cut_length("0") == 0.0 and cut_length(None) is None
    with pytest.raises(ValueError, match="--cut: '-1 mm' is not a length of at least 0"):
        cut_length("-1 mm")


@pytest.mark.parametrize(
    "read, text, message",
    [
        (length, "0", "--x: '0' is not a length above 0; give one such as '8 mm'"),
        (length, "1,000", "--x: '1,000' is not a number with a unit"),
        (grain_size, "0,5", "--x: '0,5' has no unit"),
        (grain_size, "-1 mm", "--x: '-1 mm' is not a length above 0; give one such as '90 mm'"),
        (duration, "10", "--x: '10' has no unit"),
        (duration, "0 s", "--x: '0 s' is not a time above 0; give one such as '0.1 s'"),
    ],
)
def test_the_message_has_the_option_and_the_text_as_given(read, text, message):
    with pytest.raises(ValueError) as error:
        read("--x", text)
    assert str(error.value).startswith(message)


def test_the_check_of_an_output_leaves_all_files_as_they_are(tmp_path):
    other = tmp_path / "bed.nc.part"
    other.write_text("kept")
    check_writable(tmp_path / "bed.nc")
    assert other.read_text() == "kept" and list(tmp_path.iterdir()) == [other]
    with pytest.raises(ValueError, match="is read by this command"):
        check_writable(other, tmp_path / "none", other)
    with pytest.raises(OSError, match="cannot be written"):
        check_writable(other / "bed.nc")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match="pipe is a device or a pipe, and not a file; give another path"):
        check_writable(tmp_path / "pipe")
    check_writable(tmp_path / "pipe", is_replaced=False)
