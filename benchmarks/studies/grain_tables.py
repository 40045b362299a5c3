"""Statistics of the synthetic grains: forms, Table 2's row with tests of normality, principal components, decimation.

    python -m benchmarks.studies.grain_tables            # prints the statistics
    python -m benchmarks.studies.grain_tables --write    # also writes the tables to results/reference/grains

The grains are those of config/config.yaml, which all studies of synthetic grains pack. It takes a few minutes of CPU
time.
"""

import argparse

import yaml

from benchmarks.tables import significant
from simcore.grains.sources import load_grains
from simcore.paths import CONFIG, REFERENCE
from simcore.report.grains import grain_findings
from simcore.scene.specification import resolve

FOLDER = REFERENCE / "grains"


def grain_tables():
    """Return the tables, dict of DataFrames by name, with numbers of six significant digits."""
    campaign = resolve(yaml.safe_load((CONFIG / "config.yaml").read_text(encoding="utf-8")), "config")
    tables = grain_findings(load_grains(campaign["grains"])).tables
    return {name: significant(table) for name, table in tables.items()}


def main(arguments=None) -> None:
    """Print the statistics and, with --write, write all tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the tables to results/reference/grains")
    options = parser.parse_args(arguments)
    tables = grain_tables()
    if options.write:
        FOLDER.mkdir(exist_ok=True)
        for name, table in tables.items():
            table.to_csv(FOLDER / f"{name}.csv", index=False, lineterminator="\n")
    print(tables["statistics"].to_string(index=False))
    print(tables["components"].to_string(index=False))


if __name__ == "__main__":
    main()
