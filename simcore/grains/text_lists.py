"""Lists in messages: the first items, and the number of those left out."""


def join_first(texts, count, mark=", ") -> str:
    """Return the first `count` texts with `mark` between them, and the number of further ones: "a, b and 3 more"."""
    shown = mark.join(texts[:count])
    return shown if len(texts) <= count else f"{shown} and {len(texts) - count} more"
