"""Write figures to files."""

from pathlib import Path

from matplotlib import rc_context

from simcore.writing import whole_file

RESOLUTION = 150  # dots per inch
# Text remains text in a vector file, and the file has the same bytes each time that it is written.
VECTOR = {"pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": "scree"}
_DATES = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}


def save_figure(figure, paths, test_only=False):
    """Write the figure to `paths`, one path or several; test_only: write "test only" across it.

    The suffix of a path selects the format: .png, or .pdf and .svg as vectors.
    """
    if test_only:
        figure.text(0.5, 0.5, "test only", ha="center", va="center", rotation=30, fontsize=40, color="0.6", alpha=0.5)
    for path in [paths] if isinstance(paths, str | Path) else paths:
        suffix = Path(path).suffix.lower()
        with rc_context(VECTOR), whole_file(path) as part:
            figure.savefig(part, format=suffix[1:] or None, dpi=RESOLUTION, metadata=_DATES.get(suffix))
