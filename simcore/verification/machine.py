"""What the run times in tables of error against CPU time were measured on."""

from simcore.compilation import source_digest
from simcore.provenance.machine import describe_host


def describe_machine() -> str:
    """Return processor, cores, versions and the digest of the compiled sources in one line."""
    return f"{describe_host()}, code {source_digest()}"
