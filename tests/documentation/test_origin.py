"""Each committed table has its origin in the manifest: a commit, machine and CPU hours, or what it is computed from."""

import re
import subprocess

import pandas as pd
import pytest

from docs.generate import origin, results
from simcore.paths import REFERENCE, ROOT

MEASURED = {path: entry for path, entry in results.sentences().items() if "commit" in entry}


def rows_of(path):
    return pd.read_csv(REFERENCE / path, comment="#" if path.startswith("r22/") else None)


def git(*arguments):
    """Return the status and the output of git in the root of the project; None if there is no git or repository."""
    try:
        done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    except FileNotFoundError:
        return None
    return None if done.returncode == 128 and "not a git repository" in done.stderr else (done.returncode, done.stdout)


def test_each_table_has_one_origin():
    for path, entry in results.sentences().items():
        origins = [origin.is_published(path), origin.is_gathered(path), "computed_from" in entry, "commit" in entry]
        assert sum(origins) == 1, f"{path}: give one of `commit` and `computed_from` in docs/generate/results.yaml"
        assert set(entry) <= {"what", "command", "commit", "machine", "hours", "computed_from"}, path
        assert "commit" in entry or not {"machine", "hours"} & set(entry), path


@pytest.mark.parametrize("path", MEASURED)
def test_origins_of_measured_tables_have_their_form(path):
    entry, rows = MEASURED[path], rows_of(path)
    assert re.fullmatch(r"[0-9a-f]{7}", entry["commit"])
    assert "machine" not in entry or "machine" not in rows, "the column has the machine"
    hours = entry.get("hours")
    assert hours is None or hours == "cpu_s" and rows.cpu_s.sum() > 0 or hours > 0


def test_the_commits_of_measured_tables_are_in_the_history():
    if git("rev-parse", "--is-shallow-repository") != (0, "false\n"):
        pytest.skip("this is no clone with the whole history")
    commits = sorted({entry["commit"] for entry in MEASURED.values()})
    assert [commit for commit in commits if git("merge-base", "--is-ancestor", commit, "HEAD")[0] != 0] == []


def test_the_page_has_what_is_recorded_and_what_is_not():
    text = {path: origin.origin(path, results.sentences()[path], rows_of(path)) for path in results.committed_tables()}
    assert text["height.csv"] == "Commit: `92d72f7`. Machine: not recorded. CPU hours: not recorded."
    hours = pd.read_csv(REFERENCE / "bed_size.csv").cpu_s.sum() / 3600.0
    assert f"CPU hours: {hours:.2g}." in text["bed_size.csv"]
    assert text["models/single_form.csv"] == "It is computed from other committed tables."
    assert text["r22/table3_cases.csv"] == ""
    assert "AMD EPYC" in text["verification_packings.csv"] and "code" not in text["verification_packings.csv"]
    assert re.match(r"Commit: .*`\w{7}`|Commit: \d+ commits", text["near_spheres.csv"])
    page = results.page()
    assert [path for path in text if f"\n### {path}\n" not in page or text[path] not in page] == []


def test_the_origin_of_gathered_rows_is_that_of_their_studies(monkeypatch):
    studies = pd.DataFrame(
        {
            "table": ["a.csv", "a.csv", "b.csv"],
            "packings": [2, 1, 1],
            "cpu_h": [0.5, 0.25, 7.0],
            "code": ["0.1.0+e56a (1234567) 0.1.0+e56a (2345678+)", "0.2.0+e56a (12345678)", "0.2.0+e56a (3456789)"],
            "machine": ["one; another", "one", "third"],
        }
    )
    monkeypatch.setattr(origin, "_collected", lambda: studies)
    rows = pd.DataFrame({"n": [0.4, 0.4, 0.4]})
    expected = "Commit: `1234567`, `2345678`. Machine: another; one. CPU hours: 0.75."
    assert origin.origin("a.csv", {}, rows) == expected
    more = pd.DataFrame({"n": 4 * [0.4], "cpu_s": 4 * [1800.0]})
    text = origin.origin("a.csv", {}, more)
    assert "(3 of 4 rows; of the others it is not recorded)" in text and text.endswith("CPU hours: 2.")
