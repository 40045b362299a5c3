"""Hooks of MkDocs: the generated pages become files of the site, without a copy on the disk."""

import sys
from pathlib import Path

from mkdocs.structure.files import File

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from docs.generate.pages import pages  # noqa: E402


def on_files(files, config):
    """Add the generated pages."""
    for path, text in pages().items():
        files.append(File.generated(config, path, content=text))
    return files
