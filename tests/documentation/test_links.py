"""Every link of a page leads to a page, a file or a heading; code names no page that does not exist."""

from tests.helpers.links import anchors, dead_links, dead_paths, page_texts

PAGES = "docs/"  # so that the check of paths in code does not find those of this test


def test_every_link_leads_somewhere():
    assert dead_links(page_texts()) == []


def test_code_and_configuration_name_pages_that_exist():
    assert dead_paths(page_texts()) == []


def test_every_page_is_in_one_of_the_parts():
    parts = {path.split("/")[1] for path in page_texts() if path.startswith("docs/")}
    assert parts == {"index.md", "tutorials", "how_to", "reference", "explanation", "appendices"}, "move the page"


def test_a_dead_link_and_a_dead_heading_are_reported():
    texts = {
        f"{PAGES}a.md": "# A\n[one](b.md) [two](c.md) [three](b.md#here) [four](#a) `[five](d.md)`\n",
        f"{PAGES}b.md": "# B\n\n## There it is\n",
    }
    assert dead_links(texts) == [
        f"{PAGES}a.md: c.md leads to no page or file",
        f"{PAGES}a.md: b.md#here leads to no heading of {PAGES}b.md",
    ]


def test_headings_have_the_anchors_of_mkdocs_and_of_github():
    assert anchors("## µ and n\n") == {"µ-and-n", "and-n"}
    assert anchors("### `a.b` {#a.b}\n```\n# no heading\n```\n") == {"a.b"}
    assert "what-is-stable" in anchors("## What is stable?\n")


def test_a_path_in_code_that_does_not_exist_is_reported(tmp_path):
    (tmp_path / "code.py").write_text(f"# see {PAGES}gone.md and {PAGES}there.md\n")
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "there.md").write_text("# There\n")
    assert dead_paths({}, tmp_path) == [f"code.py names {PAGES}gone.md, which does not exist"]
