"""environment.txt and pyproject.toml list the same packages with the same bounds, but for the extra `pores`."""

import tomllib

from simcore.__main__ import EXTRAS
from simcore.paths import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


# PoreSpy and OpenPNM bring 1.2 GB, which a clone does not need; their tests are skipped without them.
IN_ENVIRONMENT = set(PROJECT["optional-dependencies"]) - {"pores"}


def in_environment():
    lines = (ROOT / "environment.txt").read_text(encoding="utf-8").splitlines()
    return [line.strip() for line in lines if line.strip() and not line.startswith("#")]


def test_both_files_list_the_same():
    listed = [
        *PROJECT["dependencies"],
        *(line for extra in sorted(IN_ENVIRONMENT) for line in PROJECT["optional-dependencies"][extra]),
    ]
    assert len(set(listed)) == len(listed)
    assert sorted(in_environment()) == sorted(listed)


def test_messages_name_the_extra_that_has_the_package():
    for package, extra in EXTRAS.items():
        lines = PROJECT["optional-dependencies"][extra]
        assert any(line.startswith(f"{package}>=") for line in lines), (package, extra)
