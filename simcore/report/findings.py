"""Tables, figures and models of a part of the report, by name, and how they are written to files."""

from pathlib import Path
from typing import NamedTuple

from simcore.campaign.study_tables import mark
from simcore.models.files import models_dataset
from simcore.report.figures.saving import save_figure

OWN = "this campaign"  # in the column packed_by of tables of models


class Findings(NamedTuple):
    """Tables and figures by name, and models by (name, case)."""

    tables: dict = {}
    figures: dict = {}
    models: dict = {}

    def __or__(self, other):
        return Findings(*(first | second for first, second in zip(self, other, strict=True)))

    def write(self, output, test_only: bool = False) -> None:
        """Write each table and figure to the file that `output` gives for its name.

        output: mapping from names to a path, or for a figure to several paths; it may have further names. test_only:
        mark tables and figures as made from packings that are far too small.
        """
        for name, table in self.tables.items():
            mark(table, test_only).to_csv(output[name], index=False)
        for name, figure in self.figures.items():
            save_figure(figure, output[name], test_only)

    def write_into(self, folder) -> None:
        """Write all tables as CSV and all figures as PNG and PDF, by their names, into a new folder."""
        folder = Path(folder)
        folder.mkdir(parents=True)
        # A table and its figure may share a name.
        self._replace(figures={}).write({name: folder / f"{name}.csv" for name in self.tables})
        paths = {name: [folder / f"{name}{suffix}" for suffix in (".png", ".pdf")] for name in self.figures}
        self._replace(tables={}).write(paths)

    def write_models(self, path, title: str, test_only: bool = False) -> None:
        """Write the models with the covariances of their coefficients to a netCDF file."""
        dataset = models_dataset(self.models, self.tables["models"], title)
        dataset.assign_attrs(test_only=int(test_only)).to_netcdf(path)
