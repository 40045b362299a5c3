"""Page of the committed tables: the manifest of results.

results.yaml has a sentence for each table of results/reference, and the command that makes it where collected.csv does
not name one. docs.generate.origin adds commit, machine and hours.
"""

import functools
from pathlib import Path

import pandas as pd
import yaml

from docs.generate.markdown import code, sentence, table
from docs.generate.origin import origin
from simcore.paths import REFERENCE
from simcore.reference.columns import find_column

SENTENCES = Path(__file__).with_name("results.yaml")
FOLDERS = {
    "": "Rows of the campaigns and of single studies",
    "work_precision": "Error against run time",
    "default": "Tables of a finished default campaign",
    "default/models": "Models of a finished default campaign",
    "born_above_bed": "Rows that newer ones have replaced",
    "models": "Fitted models",
    "grains": "Statistics of the synthetic grains",
    "r22": "Published tables of Rettinger et al. (2022)",
}
_HEAD = """# Results: the committed tables

The folder `results/reference/` has these tables. All numbers on the pages of this site follow from them, or from the
command that is named beside a number. A campaign that runs on your machine writes its own tables elsewhere in
`results/`. The meaning of every column is listed below each table, and on the page [columns of the
tables](columns.md).

The commit of a table is that of the code that made it, or else the one that added its values. CPU hours are those of
all its packings or scenes.
"""


def committed_tables():
    """Return the paths of all committed tables below results/reference, sorted."""
    return sorted(path.relative_to(REFERENCE).as_posix() for path in REFERENCE.rglob("*.csv"))


@functools.cache
def sentences():
    """Return what is written about the tables: dict from path to dict with the keys of results.yaml."""
    return yaml.safe_load(SENTENCES.read_text(encoding="utf-8"))


def page():
    """Return the page of the committed tables."""
    parts = [_HEAD]
    listed = sentences()
    for folder, title in FOLDERS.items():
        parts.append(f"## {title}")
        for path in committed_tables():
            if Path(path).parent.as_posix() == (folder or "."):
                parts += [f"### {path}", *_described(path, listed.get(path, {"what": ""}))]
    return "\n\n".join(filter(None, parts)) + "\n"


def _described(path, entry):
    rows = pd.read_csv(REFERENCE / path, comment="#" if path.startswith("r22/") else None)
    names = [name for name in rows.columns if not name.startswith("Unnamed")]
    columns = [(name, find_column(path, name)) for name in names]
    cells = [[code(name), column.unit, sentence(column.meaning)] for name, column in columns if column]
    heads = ["column", "unit", "meaning"]
    if not any(cell[1] for cell in cells):
        heads, cells = ["column", "meaning"], [[cell[0], cell[2]] for cell in cells]
    command = entry.get("command") or commands().get(path)
    yield sentence(entry["what"])
    yield f"It has {len(rows)} row{'s' if len(rows) != 1 else ''}." + (f" Command: `{command}`." if command else "")
    yield origin(path, entry, rows)
    yield '??? note "Columns"\n\n' + "\n".join(f"    {line}" for line in table(heads, cells).splitlines())


@functools.cache
def commands():
    """Return the commands that made the rows of each table that a campaign gathers, from collected.csv."""
    collected = pd.read_csv(REFERENCE / "collected.csv").dropna(subset="command")
    made = {}
    for row in collected.itertuples():
        for command in row.command.split("; "):
            text = f"{command.replace('snakemake', 'snakemake --cores 1', 1)} -- collect"
            made.setdefault(row.table, {})[text] = None
    return {table: "; ".join(texts) for table, texts in made.items()}
