"""Lists in messages: the first items, and the number of those left out."""


def join_first(texts, most, mark=", ") -> str:
    """Return the first `most` texts with `mark` between them, and the number of further ones: "a, b and 3 more"."""
    shown = mark.join(texts[:most])
    return shown if len(texts) <= most else f"{shown} and {len(texts) - most} more"
