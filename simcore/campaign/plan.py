"""The plan of a campaign: its packings, their cost, pieces that end within some hours, and what is left to pack.

No numba is needed, as Snakemake reads its rules for every job that it starts.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from simcore.campaign import deposits
from simcore.campaign.biases import bias_note, measured_biases
from simcore.campaign.gathering import not_gathered
from simcore.campaign.studies import expand
from simcore.grains.sources import set_name, source_name
from simcore.packing.cost import estimate
from simcore.packing.forecast import check_bed, typical_grains
from simcore.paths import REFERENCE
from simcore.scene.domain import Domain

# Four features, an intercept and something left to judge them by.
SMALLEST_MIXTURE_STUDY = 7


def number_pieces(cpu_hours, seeds, most):
    """The piece, from 1, that each packing of a study belongs to, (n,) int.

    cpu_hours: estimate of each packing (n,); seeds (n,): all packings of the least seed come first, so that a study
    that is broken off has every setting before it has any twice. A piece ends before its packings take more than
    `most` hours; a packing that takes longer is a piece by itself.
    """
    pieces, piece, filled = np.empty(len(cpu_hours), int), 0, np.inf
    for k in np.argsort(seeds, kind="stable"):
        if filled + cpu_hours[k] > most:
            piece, filled = piece + 1, 0.0
        pieces[k] = piece
        filled += cpu_hours[k]
    return pieces


def estimate_studies(packings, in_all):
    """DataFrame with one row a study and one of all: study, packings, grains, cpu_h, longest_h, pieces.

    packings: one row a packing, columns study, cost (a PackingCost) and piece. in_all: names of the studies that `all`
    holds; they come first, the row "all" is theirs, and the others follow it. longest_h: of a single packing.
    """
    costs = pd.DataFrame(
        {
            "study": packings["study"],
            "packings": 1,
            "grains": [cost.grains for cost in packings["cost"]],
            "cpu_h": [cost.cpu_seconds / 3600.0 for cost in packings["cost"]],
            "piece": packings["piece"],
        }
    )
    groups = costs.groupby("study", sort=False)
    table = groups[["packings", "grains", "cpu_h"]].sum()
    table = table.assign(longest_h=groups["cpu_h"].max(), pieces=groups["piece"].max())
    inside = table[table.index.isin(in_all)]
    everything = (
        inside[["packings", "grains", "cpu_h", "pieces"]].sum().to_frame().T.assign(longest_h=inside.longest_h.max())
    )
    everything.index = ["all"]
    table = pd.concat([inside, everything, table.drop(inside.index)]).rename_axis("study").reset_index()
    return table.astype({"packings": int, "grains": int, "pieces": int})


def describe_studies(table, piece_hours):
    """The table of estimate_studies as lines of text."""
    lines = [f"{'study':<24}{'packings':>9}{'grains':>10}{'CPU hours':>11}{'longest':>9}{'pieces':>8}"]
    for row in table.itertuples():
        lines.append(
            f"{row.study:<24}{row.packings:>9}{row.grains:>10}{row.cpu_h:>11.2f}{row.longest_h:>9.2f}{row.pieces:>8}"
        )
    lines.append(
        f"Estimated for one thread, compiling apart; a piece takes at most {piece_hours:g} CPU hours and is a target, "
        f"such as {table.study.iloc[0]}_piece_1. Below `all`: studies that are made only when they are asked for."
    )
    return "\n".join(lines)


def check_beds(packings, cut=None):
    """ValueError where the bed of a packing will be too low for its porosity to be evaluated with that cut.

    packings: one row a packing, columns study, packing and specification. cut: of the campaign's group `porosity`.
    """
    for row in packings.itertuples():
        specification = row.specification
        try:
            density = specification["material"]["density"]
            check_bed(Domain(**specification["domain"]), typical_grains(specification), density, cut)
        except ValueError as error:
            raise ValueError(
                f"studies.{row.study}, packing {row.packing}: {error} To evaluate a lower bed, set porosity.cut."
            ) from None


class Plan:
    """The packings of a campaign with their cost, and what the rules of the workflow take from them.

    packings: DataFrame of simcore.campaign.studies.expand with the further columns cost (a PackingCost), is_first (of
    its study), grain_folder (of its grain set, or empty), source (name of its grains' source), piece and ranks.
    studies: names of those that are part of `all`; all_studies: of every one.
    """

    def __init__(self, campaign, overlays=()):
        """Expand a resolved campaign. ValueError names the study and the key at fault.

        overlays: paths of the configurations over config.yaml, for the command that makes the campaign again.
        """
        self.campaign = campaign
        self.results = campaign["pathvars"]["results"]
        self.command = " ".join(["snakemake --configfile", *overlays])
        self.packings = _with_cost(expand(campaign), campaign)
        self.all_studies = list(self.packings.study.unique())
        self.studies = [name for name in self.all_studies if campaign["studies"][name]["in_all"]]
        self._rows = {(row.study, row.packing): row for row in self.packings.itertuples()}
        # Another source, or other content of its files, is another set beside it, so that campaigns in one folder do
        # not write over each other's grains. The report shows the campaign's own set.
        groups = [campaign["grains"], *self.packings.grains[self.packings.grains.notna()]]
        self._grain_groups = {set_name(group): group for group in groups}

    def check(self):
        """ValueError where a bed will be too low for its porosity to be evaluated with the campaign's cut."""
        # Of deposits the fabric is evaluated, with other cuts.
        check_beds(
            self.packings[~self.packings.study.str.startswith(deposits.PREFIX)], self.campaign["porosity"]["cut"]
        )

    def description(self):
        """What the campaign will cost, study by study, as lines of text."""
        return describe_studies(estimate_studies(self.packings, self.studies), self.campaign["piece_hours"])

    # Studies

    def title(self, study):
        """The title of a study, or its name where it has none."""
        return self.campaign["studies"][study]["title"] or study

    @property
    def titles(self):
        """Titles of the studies that are part of `all`, dict by name."""
        return {study: self.title(study) for study in self.studies}

    def studies_named(self, prefix):
        """Names of all studies that begin with a prefix."""
        return [study for study in self.all_studies if study.startswith(prefix)]

    def of(self, *studies):
        """The rows of `packings` of these studies."""
        return self.packings[self.packings.study.isin(studies)]

    @property
    def in_report(self):
        """The rows of `packings` of the studies that are part of `all`."""
        return self.of(*self.studies)

    def pieces(self):
        """The pieces of all studies, list of (study, number from 1, names of its packings)."""
        groups = self.packings.groupby(["study", "piece"], sort=False)
        return [(study, piece, list(rows.packing)) for (study, piece), rows in groups]

    def varied(self, study):
        """Names of what a study varies."""
        return list(self.of(study).row.iloc[0]["varied"])

    # Grains

    @property
    def grain_set(self):
        """Name of the campaign's own set of grains."""
        return set_name(self.campaign["grains"])

    def grain_group(self, name):
        """The resolved group `grains` behind the set of this name. KeyError where no packing takes it."""
        return self._grain_groups[name]

    @property
    def shows_grains(self):
        """Whether a study of `all` takes the campaign's own grains; spheres, and ellipsoids of a given form, do not."""
        return bool((self.in_report.grain_folder == self.grain_set).any())

    # The machine

    def ranks(self, study, packing):
        """Number of MPI processes of a packing."""
        return int(self._rows[study, packing].ranks)

    def cores(self, study, packing):
        """Number of cores of a packing: its ranks times threads."""
        return self.ranks(study, packing) * self.campaign["threads"]

    def memory_mb(self, study, packing, attempt=1):
        """Memory to request for a packing [MB], more at each attempt."""
        return attempt * self._rows[study, packing].cost.memory_mb(self.ranks(study, packing))

    def minutes(self, study, packing, attempt=1):
        """Wall-clock time to request for a packing [min], more at each attempt."""
        return attempt * self._rows[study, packing].cost.minutes(self.cores(study, packing))

    def mpiexec(self, study, packing):
        """Command that starts the ranks of a packing; "" for one rank, as the executor for Slurm refuses MPI then."""
        return self.campaign["mpiexec"] if self.ranks(study, packing) > 1 else ""

    # Committed rows

    def planned(self, study, source=None):
        """Packings of a study as simcore.campaign.gathering takes them, of grains of one source or of all."""
        return [
            {"row": row.row, "specification": row.specification, "cpu_h": row.cost.cpu_seconds / 3600.0}
            for row in self.of(study).itertuples()
            if source in (None, row.source)
        ]

    def planned_by_source(self, study):
        """Packings of a study as of `planned`, dict from the name of their grains' source."""
        return {source: self.planned(study, source) for source in self.of(study).source.unique()}

    def files_left(self, study):
        """Evaluations of those packings of a study that have no row in the committed tables yet, as paths of rules."""
        folder, plans = "porosity", self.planned_by_source(study)
        if study.startswith(deposits.PREFIX):
            folder, plans = "fabric", {deposits.SOURCE: self.planned(study)}
        return [
            f"<results>/{folder}/{study}/{packing['row']['packing']}.nc"
            for source, planned in plans.items()
            for packing in not_gathered(self.campaign["reference"], study, source, planned)
        ]

    def to_gather(self):
        """Packings by study and source whose rows may be gathered.

        They are of the studies of `all`, and of others of which something was evaluated here.
        """
        return {
            study: self.planned_by_source(study)
            for study in self.all_studies
            if study in self.studies or Path(self.results, "porosity", study).is_dir()
        }

    def bias_notes(self):
        """What is known of the bias of each study of `all`, a sentence by name."""
        biases = measured_biases(REFERENCE)
        return {study: bias_note(list(self.of(study).specification), biases) for study in self.studies}

    # Models

    @property
    def cases_committed(self):
        """Cases whose models are fitted to committed rows of single forms, as this campaign packs none of them."""
        single_forms = self.of(*self.studies_named("single_form"))
        packed = {specification["sizes"]["case"] for specification in single_forms.specification}
        return sorted(set(self.campaign["models"]["committed"]) - packed)

    @property
    def committed_single_forms(self):
        """Path of the committed rows of `cases_committed`; None where none are needed or none are there."""
        path = REFERENCE / "single_form.csv"
        return path if self.cases_committed and path.exists() else None

    @property
    def fits_mixtures(self):
        """Whether the campaign has enough mixtures of form for a model of them."""
        return len(self.of("form_mixtures")) >= SMALLEST_MIXTURE_STUDY


def _with_cost(packings, campaign):
    """The packings of `expand` with the columns that Plan adds."""
    # No result depends on what a packing asks of the machine, so nothing of it may stand in `params` of a rule.
    costs = packings.specification.map(estimate)
    hours = np.array([cost.cpu_seconds / 3600.0 for cost in costs])
    seeds = np.array([specification["seed"] for specification in packings.specification])
    pieces = np.zeros(len(packings), int)
    for rows in packings.groupby("study").indices.values():
        pieces[rows] = number_pieces(hours[rows], seeds[rows], campaign["piece_hours"])
    return packings.assign(
        cost=costs,
        is_first=~packings.study.duplicated(),
        grain_folder=packings.grain_set.str.partition("/")[0],
        source=[source_name((group or campaign["grains"])["source"]) for group in packings.grains],
        piece=pieces,
        ranks=[cost.ranks(campaign["ranks"], campaign["grains_per_rank"]) for cost in costs],
    )
