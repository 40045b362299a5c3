"""Libraries that only exports and the terminal need; they are the extra `view`."""

import importlib


def library(name: str, purpose: str):
    """Return the library with this module name. ValueError if it is not installed; purpose: what needs it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ValueError(
            f"{purpose} needs the library {name}, which cannot be imported ({error}). Install it: "
            "pip install '.[view]' in the folder of Scree"
        ) from None
