"""The name of the code that made a file: version, digest of its sources, and commit."""

import functools
import subprocess

from simcore.paths import ROOT
from simcore.provenance.digest import digest
from simcore.provenance.version import VERSION


def code_name(sources: str) -> str:
    """Return the version, the digest `sources` and, in a git checkout, the commit ("+": files were changed)."""
    commit = _commit()
    return f"{VERSION}+{sources} ({commit})" if commit else f"{VERSION}+{sources}"


@functools.cache
def name_of_sources(path: str) -> str:
    """Return the name of the code in a file of the clone and in all that it imports."""
    return code_name(digest(path)[:12])


@functools.cache
def _commit():
    if not (ROOT / ".git").exists():
        return ""
    try:
        described = subprocess.run(
            ["git", "describe", "--always", "--dirty=+"], cwd=ROOT, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return ""
    return described.stdout.strip()
