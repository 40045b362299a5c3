"""What `scree pack` refuses on two ranks: one line, status 2, and no rank waits for the other."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from simcore.paths import ROOT

PATIENCE = 120  # [s]; a rank that waits for the other one never ends
SPECIFICATION = """
accuracy: draft
shapes: {kind: sphere}
sizes: {case: U1}
domain: {type: periodic, width: 30 mm, height: 0.2 m}
amount: {grains: 20}
"""


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["folder"], "folder is a folder; give the name of a file in it"),
        (["bed.nc", "--log", "bed.nc"], "--log: bed.nc is the file of the packing; give another path"),
    ],
)
def test_wrong_files_end_both_ranks_with_one_line(tmp_path, arguments, message):
    (tmp_path / "folder").mkdir()
    (tmp_path / "spec.yaml").write_text(SPECIFICATION)
    mpiexec = Path(sys.executable).with_name("mpiexec")
    done = subprocess.run(
        [mpiexec, "-n", "2", sys.executable, "-m", "simcore", "pack", "spec.yaml", *arguments],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert done.stderr.splitlines() == [f"scree pack: {message}"]
    assert done.returncode == 2
