"""A folder of committed rows."""

import pytest

from tests.helpers.reference_rows import write_reference


@pytest.fixture
def reference(tmp_path):
    """Return a folder of committed rows as a campaign writes them, see simcore.models.fitting.fit_reference_models."""
    return write_reference(tmp_path)
