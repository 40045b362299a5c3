"""The data that a figure shows, read back from its axes."""


def error_bar_points(axes):
    """Return the points with error bars of an axes, a dict from label to (n, 2) of x and y."""
    return {box.get_label(): box[0].get_xydata() for box in axes.containers}
