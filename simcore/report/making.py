"""When, where and by which code a page was made."""

from datetime import date

from simcore.packing.file import code_version
from simcore.provenance.machine import describe_host


def describe_making():
    """Return a sentence with today's date, the version, digest and commit of the code, and the machine."""
    return f"Made on {date.today().isoformat()} by Scree {code_version()} on {describe_host()}."
