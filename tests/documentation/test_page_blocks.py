"""PageRun reports a line that is not printed, a command that fails, and an error that no longer occurs."""

import pytest

from tests.helpers.page_blocks import PageRun, blocks_of, difference

PRINTED = "first 1\nsecond 2.00 of 3\nthird\n"


@pytest.mark.parametrize(
    "shown, share, missing",
    [
        ("first 1\n...\nthird\n", 0.0, None),
        ("third\nfirst 1\n", 0.0, "first 1"),
        ("second 2.01 of 3\n", 0.0, "second 2.01 of 3"),
        ("second 2.01 of 3\n", 0.01, None),
        ("second 2.10 of 3\n", 0.01, "second 2.10 of 3"),
        ("second 2.00 in 3\n", 0.5, "second 2.00 in 3"),
    ],
)
def test_each_shown_line_must_be_printed_in_its_order(shown, share, missing):
    assert difference(shown, PRINTED, share) == missing


@pytest.mark.parametrize(
    "shown, share, same",
    [
        ("B − A  +0.020 ± 0.010  −0.01 to +0.05  3 pairs", 0.1, True),
        ("B − A  +0.020 ± 0.010  −0.01 to +0.05  3 pairs", 0.0, False),
        ("B − A  +0.030 ± 0.002  +0.01 to +0.02  3 pairs", 0.1, False),
        ("B − A  −0.020 ± 0.002  +0.01 to +0.02  3 pairs", 0.1, False),
        ("B − A  +0.020          +0.01 to +0.02  3 pairs", 0.1, False),
    ],
)
def test_errors_and_intervals_of_differences_are_not_compared(shown, share, same):
    assert (difference(shown, "B − A  +0.020 ± 0.002  +0.01 to +0.02  3 pairs\n", share) is None) == same


@pytest.mark.parametrize(
    "shown, same", [("n 0.350 ± 0.004", True), ("n 0.350 ± 0.007", False), ("n 0.350 ± 0.0005", False)]
)
def test_errors_of_packings_may_differ_by_a_factor_of_three(shown, same):
    assert (difference(shown, "n 0.351 ± 0.002\n", 0.1) is None) == same


def test_a_mark_belongs_to_the_next_block_only():
    page = "<!-- test: fails -->\n```bash\nfalse\n```\n\n<!-- test: dry run -->\ntext\n```bash\ntrue\n```\n"
    assert [(block.content, block.mark) for block in blocks_of(page)] == [("false\n", "fails"), ("true\n", "")]
    with pytest.raises(AssertionError, match="line 1 has no end"):
        blocks_of("```bash\ntrue\n")


@pytest.mark.parametrize(
    "page, message",
    [
        ("```bash\nfalse\n```\n", "line 1: exit 1"),
        ("<!-- test: fails -->\n```bash\ntrue\n```\n", "line 2: exit 0"),
        ("```bash\necho one\n```\n```text\ntwo\n```\n", "line 4: not printed: two"),
        ("```python\nprint(1 + 1)\n```\n```text\n3\n```\n", "line 4: not printed: 3"),
    ],
)
def test_what_a_page_says_wrongly_is_reported_with_its_line(page, message, tmp_path):
    with pytest.raises(AssertionError, match=message):
        PageRun(tmp_path).run(page)


def test_a_named_block_becomes_a_file(tmp_path):
    run = PageRun(tmp_path)
    run.run("```csv\n# a.csv\nL,I,S\n```\n```yaml\n# b.yaml\na: 1\n```\n```bash\ncat a.csv b.yaml\n```\n")
    assert run.printed == "L,I,S\n# b.yaml\na: 1\n"
