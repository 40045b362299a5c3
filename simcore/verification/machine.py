"""Description of the machine for tables of error against CPU time."""

from simcore.compilation import source_digest
from simcore.provenance.machine import describe_host


def describe_machine() -> str:
    """Return processor, number of cores, versions and the digest of the compiled sources in one line."""
    return f"{describe_host()}, code {source_digest()}"
