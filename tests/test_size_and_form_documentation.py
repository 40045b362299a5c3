"""The example in docs/how_to/predict_from_a_sieve_curve.md is what the command prints."""

import re

from simcore.__main__ import main
from simcore.paths import ROOT


def test_the_example_is_what_the_command_prints(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    text = (ROOT / "docs" / "how_to" / "predict_from_a_sieve_curve.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```(\w*)\n(.*?)\n```$", text, re.DOTALL | re.MULTILINE)
    command, output = (content for language, content in blocks if language in ("", "text"))
    assert main(command.removeprefix("scree ").split()) == 0
    assert capsys.readouterr().out.rstrip("\n") == output
