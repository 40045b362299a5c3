"""Links between the pages of the documentation, and paths of pages that code and configuration name."""

import functools
import re
import unicodedata
from pathlib import Path

from docs.generate.pages import pages
from simcore.paths import ROOT

DOCS = ROOT / "docs"
# Pages outside docs/ whose links are checked too.
OTHER_PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "config/README.md")
# Files in which paths such as docs/how_to/export.md are checked.
NAMING = ("*.py", "*.yaml", "*.tsv", "*.smk", "*.md", "*.toml", "Makefile")
_LINK = re.compile(r"!?\[[^\]]*\]\(<?([^)\s>]+)>?[^)]*\)")
_PATH = re.compile(r"(?<![\w/.])docs/[\w/*.-]+\.(?:md|png)")
_HEADING = re.compile(r"^#+ +(.*?)(?: *\{ *#([^} ]+) *\})? *$", re.MULTILINE)


def page_texts():
    """Return all pages, written and generated: dict from the path in the clone to text."""
    written = {path.relative_to(ROOT).as_posix(): path for path in sorted(DOCS.rglob("*.md"))}
    written |= {name: ROOT / name for name in OTHER_PAGES}
    texts = {name: path.read_text(encoding="utf-8") for name, path in written.items()}
    return texts | {f"docs/{name}": text for name, text in pages().items()}


def dead_links(texts):
    """Return what is wrong with the links of pages, a line each. texts: as of `page_texts`.

    A link without a scheme must lead to a page, to a file of the clone, or to a heading. Links to web sites are not
    checked.
    """
    lines = []
    for name, text in texts.items():
        for target in _LINK.findall(_without_code(text)):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            page = _resolved(name, path)
            if page not in texts and not (ROOT / page).exists():
                lines.append(f"{name}: {target} leads to no page or file")
            elif anchor and page in texts and anchor not in anchors(texts[page]):
                lines.append(f"{name}: {target} leads to no heading of {page}")
    return lines


def dead_paths(texts, root=ROOT):
    """Return the paths of pages and pictures that files of the clone name but that do not exist, a line each."""
    lines = []
    for pattern in NAMING:
        for path in sorted(root.rglob(pattern)):
            name = path.relative_to(root).as_posix()
            if name.startswith((".", "build/", "results/site/")) or name == "CHANGELOG.md":
                continue
            for target in _PATH.findall(path.read_text(encoding="utf-8")):
                if target not in texts and not any(root.glob(target)):
                    lines.append(f"{name} names {target}, which does not exist")
    return sorted(set(lines))


def anchors(text):
    """Return the anchors of a page: those of its headings, as MkDocs and as GitHub name them, and explicit ones."""
    names = set(re.findall(r"""\bid=["']([^"']+)""", text))
    for heading, explicit in _HEADING.findall(_without_blocks(text)):
        names |= {explicit} if explicit else _slugs(heading)
    return names


def _slugs(heading):
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").replace("*", "")
    ascii_only = unicodedata.normalize("NFKD", plain).encode("ascii", "ignore").decode()
    of_mkdocs = re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", ascii_only).strip().lower())
    of_github = re.sub(r"[^\w\s-]", "", plain.lower()).strip().replace(" ", "-")
    return {of_mkdocs, of_github}


@functools.cache
def _resolved(page, path):
    """Return the path in the clone that a link of a page leads to."""
    if not path:
        return page
    parts = []
    for part in (Path(page).parent / path).parts:
        if part == "..":
            parts = parts[:-1] if parts else [".."]
        elif part != ".":
            parts.append(part)
    return "/".join(parts)


def _without_blocks(text):
    return re.sub(r"^(```|~~~).*?^\1", "", text, flags=re.DOTALL | re.MULTILINE)


def _without_code(text):
    return re.sub(r"`[^`\n]*`", "", _without_blocks(text))
