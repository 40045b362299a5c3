"""A figure is written as a picture and as vectors, the same each time."""

from matplotlib.figure import Figure

from simcore.report.figures.saving import save_figure


def draw():
    figure = Figure(figsize=(2, 2))
    figure.subplots().plot([0, 1], [0, 1])
    return figure


def test_all_paths_are_written_and_vectors_carry_no_date(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        save_figure(draw(), [tmp_path / folder / name for name in ("f.png", "f.pdf", "f.svg")])
    for name, start in (("f.png", b"\x89PNG"), ("f.pdf", b"%PDF"), ("f.svg", b"<?xml")):
        first, second = ((tmp_path / folder / name).read_bytes() for folder in ("a", "b"))
        assert first.startswith(start)
        assert first == second


def test_test_only_is_written_across_once_for_all_files(tmp_path):
    figure = draw()
    save_figure(figure, [str(tmp_path / "f.png"), str(tmp_path / "f.pdf")], test_only=True)
    assert [text.get_text() for text in figure.texts] == ["test only"]
