"""Writing a figure."""

RESOLUTION = 150  # dots per inch


def save_figure(figure, path, test_only=False):
    """Write the figure as PNG to `path`; across it stands "test only" if it is."""
    if test_only:
        figure.text(0.5, 0.5, "test only", ha="center", va="center", rotation=30, fontsize=40, color="0.6", alpha=0.5)
    figure.savefig(path, dpi=RESOLUTION)
