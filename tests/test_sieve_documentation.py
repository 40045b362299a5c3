"""The example in docs/how_to/sieve_curves.md is what the command prints."""

import re

from simcore.__main__ import main
from simcore.paths import ROOT


def test_the_example_is_what_the_command_prints(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    command, output = re.findall(
        r"```(?:text)?\n(.*?)\n```", (ROOT / "docs" / "how_to" / "sieve_curves.md").read_text(), re.DOTALL
    )
    assert main(command.removeprefix("scree ").split()) == 0
    assert capsys.readouterr().out.rstrip("\n") == output
