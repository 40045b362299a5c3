"""The plan of a campaign: its packings, their cost, their division into pieces, and the packings that remain.

This module needs no numba, because Snakemake reads the rules again for every job that it starts.
"""

import functools
import json
import os
import re
from pathlib import Path

import pandas as pd

from simcore.campaign import deposits
from simcore.campaign.biases import bias_effects, measured_biases
from simcore.campaign.estimates import describe_studies, estimate_studies, with_cost
from simcore.campaign.gathering import SHOWN_TABLES, not_gathered, table_of
from simcore.campaign.plan_checks import check_beds, check_committed, check_names, check_shared_tables, check_sources
from simcore.campaign.studies import expand, study_title
from simcore.grains.sources import set_name
from simcore.packing.cost import COPIES
from simcore.paths import REFERENCE
from simcore.scene.sizes import case_spacing, size_curve
from simcore.scene.specification import resolve

# simcore.models.regression.fewest_samples of the features of each model, without importing it for each job
SMALLEST_MIXTURE_STUDY, SMALLEST_SINGLE_FORM_STUDY = 7, 5


class Plan:
    """The packings of a campaign with their cost, and the values that the rules of the workflow need.

    packings: DataFrame of simcore.campaign.studies.expand with the further columns cost (a PackingCost), is_first (of
    its study), grain_folder (of its grain set, or empty), source (name of its grains' source), piece and ranks.
    studies: names of the studies that are part of the target `all`. all_studies: names of all studies.
    """

    def __init__(self, campaign, command="snakemake"):
        """Expand a resolved campaign. ValueError names the study and the wrong key.

        command: that reproduces the campaign, without a target; see simcore.campaign.command_line.
        """
        self.campaign, self.command = campaign, command
        cores = campaign["cores_per_node"]
        if cores is not None and campaign["threads"] > cores:
            raise ValueError(
                f"threads: {campaign['threads']} threads of a rank need as many cores, but cores_per_node is {cores}; "
                "lower threads or raise cores_per_node"
            )
        self.results = campaign["pathvars"]["results"]
        self.packings = with_cost(expand(campaign), campaign)
        self.all_studies = list(self.packings.study.unique())
        self.studies = [name for name in self.all_studies if campaign["studies"][name]["in_all"]]
        self._rows = {(row.study, row.packing): row for row in self.packings.itertuples()}
        # Every source and every content of its files is a set of its own, so that campaigns in one folder do not
        # overwrite each other's grains. The report shows the campaign's own set.
        groups = [campaign["grains"], *self.packings.grains[self.packings.grains.notna()]]
        self._grain_groups = {set_name(group): group for group in groups}

    def check(self):
        """Raise ValueError if the workflow cannot have these studies, or if a bed will be too low; see plan_checks."""
        check_names(self.all_studies)
        check_committed(self.campaign["models"]["committed"], REFERENCE / "single_form.csv")
        check_sources(self._grain_groups.values())
        check_shared_tables(self.packings, self.studies)
        # Deposits are left out: their fabric is evaluated, with other cuts.
        check_beds(
            self.packings[~self.packings.study.str.startswith(deposits.PREFIX)], self.campaign["porosity"]["cut"]
        )

    def description(self):
        """Return the estimated cost of the campaign, study by study, and whether it has models, as lines of text."""
        text = describe_studies(estimate_studies(self.packings, self.studies), self.campaign["piece_hours"])
        if self.fits_single_forms or self.fits_mixtures or self.cases_committed:
            return text
        return (
            f"{text}\nNo model will be fitted: a model needs a study of the target `all` with the name single_form "
            f"(at least {SMALLEST_SINGLE_FORM_STUDY} forms with one sieve curve) or form_mixtures (at least "
            f"{SMALLEST_MIXTURE_STUDY} distributions of form)."
        )

    # Studies

    def title(self, study):
        """Return the title of a study for a page; see `study_title`."""
        return study_title(study, self.campaign["studies"][study])

    @property
    def titles(self):
        """Titles of the studies that are part of `all`, as a dict by name."""
        return {study: self.title(study) for study in self.studies}

    @property
    def questions(self):
        """Questions of the studies that are part of `all`, as a dict by name; empty for a study without one."""
        return {study: self.campaign["studies"][study]["question"] for study in self.studies}

    @property
    def committed_rows(self):
        """Folder of the committed rows with which the report begins, or None.

        It begins with them if they have a study of this campaign, and the campaign is no test. The rows of
        results/reference are of the default grains and material, so that a campaign of others does not repeat them.
        """
        folder = Path(self.campaign["reference"] or os.path.relpath(REFERENCE))
        tables = {table_of(study) for study in self.studies} & set(SHOWN_TABLES)
        has_rows = any((folder / f"{table}.csv").exists() for table in tables)
        of_project = folder.resolve() == REFERENCE
        is_shown = not self.campaign["test_only"] and (self.has_default_grains or not of_project)
        return folder if has_rows and is_shown else None

    @functools.cached_property
    def has_default_grains(self):
        """Whether the studies of `all` with committed rows have the default grains, and one the default material."""
        scene = resolve({"domain": {"width": "1 m", "height": "1 m"}, "amount": {"grains": 1}, "sizes": {"case": "U1"}})
        of_default = resolve({"studies": {}}, "config")["grains"]
        rows = self.in_report[self.in_report.study.map(table_of).isin(SHOWN_TABLES)]
        grains = [group for group in rows.grains if group] or [self.campaign["grains"]]
        materials = [specification["material"] for specification in self.in_report.specification]
        return all(group == of_default for group in grains) and scene["material"] in materials

    def studies_named(self, prefix):
        """Return the names of all studies that begin with a prefix."""
        return [study for study in self.all_studies if study.startswith(prefix)]

    def of(self, *studies):
        """Return the rows of `packings` of these studies."""
        return self.packings[self.packings.study.isin(studies)]

    @property
    def in_report(self):
        """The rows of `packings` of the studies that are part of `all`."""
        return self.of(*self.studies)

    def value(self, study, packing, column):
        """Return the value of one packing in a column of `packings`. ValueError if it has a fault."""
        row = self._rows[study, packing]
        if row.fault:
            raise ValueError(row.fault)
        return getattr(row, column)

    def pieces(self):
        """Return the pieces of all studies, a list of (study, number from 1, names of the packings)."""
        groups = self.packings.groupby(["study", "piece"], sort=False)
        return [(study, piece, list(rows.packing)) for (study, piece), rows in groups]

    def varied(self, study):
        """Return the names of the columns that a study varies."""
        return list(self.of(study).row.iloc[0]["varied"])

    def curve(self, study, packing):
        """Return the listed curve of a packing as text, of which its specification has only the name."""
        sizes = self._rows[study, packing].specification["sizes"]
        if sizes["case"] is None:
            return ""
        curve = size_curve(sizes)
        return str([curve.bounds.tolist(), curve.mass_fractions.tolist(), case_spacing(sizes)])

    # Grains

    @property
    def grain_set(self):
        """Name of the campaign's own set of grains."""
        return set_name(self.campaign["grains"])

    def grain_group(self, name):
        """Return the resolved group `grains` of the set with this name. KeyError if no packing uses it."""
        return self._grain_groups[name]

    @property
    def shows_grains(self):
        """Whether a study of `all` uses the campaign's own grains; spheres, and ellipsoids of a given form, do not."""
        return bool((self.in_report.grain_folder == self.grain_set).any())

    # The machine

    def ranks(self, study, packing):
        """Return the number of MPI processes of a packing."""
        return int(self._rows[study, packing].ranks)

    def cores(self, study, packing):
        """Return the number of cores of a packing: ranks times threads."""
        return self.ranks(study, packing) * self.campaign["threads"]

    def _ranks_per_node(self, study, packing):
        """Return the maximum number of ranks of a packing that one node has cores for."""
        ranks, cores = self.ranks(study, packing), self.campaign["cores_per_node"]
        return ranks if cores is None else min(ranks, cores // self.campaign["threads"])

    def nodes(self, study, packing):
        """Return the number of nodes of a packing."""
        return -(-self.ranks(study, packing) // self._ranks_per_node(study, packing))

    def memory_mb(self, study, packing, attempt=1):
        """Return the memory to request for a packing on each of its nodes [MB].

        From the second attempt on, arrays get twice as much, and ranks enough to compile their step, as they must on
        another kind of processor. The request grows no further, because most attempts only continue a packing whose
        time was too short.
        """
        cost, ranks = self._rows[study, packing].cost, self._ranks_per_node(study, packing)
        if attempt == 1:
            return cost.memory_mb(ranks, compiled=self.campaign["compile_first"])
        return cost.memory_mb(ranks, copies=2.0 * COPIES)

    def minutes(self, study, packing, attempt=1):
        """Return the wall-clock time to request for a packing [min]; it increases with each attempt, to longest_job."""
        minutes = attempt * self._rows[study, packing].cost.minutes(self.cores(study, packing))
        longest = self.campaign["longest_job"]
        return minutes if longest is None else min(minutes, int(longest // 60.0))

    def compiled_with(self, study):
        """Return the name under which a study's steps are compiled: "all" for all studies of `all`, else its own."""
        return "all" if study in self.studies else study

    def steps_to_compile(self, name):
        """Return the specifications of a name of `compiled_with`, except those that differ only in seed or amount."""
        distinct = {}
        for specification in self.of(*(self.studies if name == "all" else [name])).specification:
            rest = {key: value for key, value in specification.items() if key not in ("name", "seed", "amount")}
            distinct.setdefault(json.dumps(rest, sort_keys=True), specification)
        return list(distinct.values())

    def mpiexec(self, study, packing):
        """Return the command that starts the ranks; "" for one rank, since the Slurm executor rejects MPI then."""
        return self.campaign["mpiexec"] if self.ranks(study, packing) > 1 else ""

    # Committed rows

    def planned(self, study, source=None):
        """Return the packings of a study as simcore.campaign.gathering needs them, for one source of grains or all."""
        return [
            {"row": row.row, "specification": row.specification, "cpu_h": row.cost.cpu_seconds / 3600.0}
            for row in self.of(study).itertuples()
            if source in (None, row.source)
        ]

    def planned_by_source(self, study):
        """Return the packings of a study as from `planned`, as a dict by the name of their grains' source."""
        return {source: self.planned(study, source) for source in self.of(study).source.unique()}

    def files_left(self, study):
        """Return the paths of the evaluations of a study's packings that have no row in the committed tables yet."""
        folder, plans = "porosity", self.planned_by_source(study)
        if study.startswith(deposits.PREFIX):
            folder, plans = "fabric", {deposits.SOURCE: self.planned(study)}
        return [
            f"<results>/{folder}/{study}/{packing['row']['packing']}.nc"
            for source, planned in plans.items()
            for packing in not_gathered(self.campaign["reference"], study, source, planned)
        ]

    def to_gather(self):
        """Return the packings, by study and source, whose rows may be gathered.

        These are the packings of the studies of `all`, and of other studies with evaluated packings in this folder.
        """
        return {
            study: self.planned_by_source(study)
            for study in self.all_studies
            if study in self.studies or Path(self.results, "porosity", study).is_dir()
        }

    def bias_effects(self):
        """Return the measured effects of settings on the porosities of each study of `all`, as a dict by name."""
        biases = measured_biases(REFERENCE)
        return {study: bias_effects(list(self.of(study).specification), biases) for study in self.studies}

    # Models

    @property
    def cases_committed(self):
        """Cases whose models are fitted to committed rows of single forms, because this campaign packs none of them.

        There are none if its grains or its material are not those of the committed rows.
        """
        if not self.has_default_grains:
            return []
        single_forms = self.in_report[self.in_report.study.str.startswith("single_form")]
        packed = {specification["sizes"]["case"] for specification in single_forms.specification}
        return sorted(set(self.campaign["models"]["committed"]) - packed)

    @property
    def committed_single_forms(self):
        """Path of the committed rows of `cases_committed`; None if they are not needed or do not exist."""
        path = REFERENCE / "single_form.csv"
        return path if self.cases_committed and path.exists() else None

    @property
    def fits_single_forms(self):
        """Whether the campaign has a study single_form and enough forms with one sieve curve for a model of them."""
        studies = [study for study in self.studies if study.startswith("single_form")]
        forms = self._grains_of_cases(*studies).groupby("case")["grain"].nunique()
        return "single_form" in studies and forms.max() >= SMALLEST_SINGLE_FORM_STUDY

    @property
    def compares_ellipsoids(self):
        """Whether the campaign packs polyhedra and equivalent ellipsoids of one grain with one sieve curve."""
        studies = ("single_form", "equivalent_ellipsoids")
        pairs = [set(map(tuple, self._grains_of_cases(study).to_numpy())) for study in studies]
        return set(studies) <= set(self.studies) and bool(set.intersection(*pairs))

    def _grains_of_cases(self, *studies):
        """Return a DataFrame with the columns case and grain, one row per packing of these studies."""
        specifications = self.of(*studies).specification
        rows = [(each["sizes"]["case"], each["shapes"]["grain"]) for each in specifications]
        return pd.DataFrame(rows, columns=["case", "grain"])

    @property
    def fits_mixtures(self):
        """Whether the campaign has enough mixtures of form with one sieve curve for a model of them."""
        mixtures = self.of("form_mixtures") if "form_mixtures" in self.studies else self.packings[:0]
        forms = {}
        for specification in mixtures.specification:
            shapes = specification["shapes"]
            form = str([shapes["flatness"], shapes["elongation"]])
            forms.setdefault(specification["sizes"]["case"], set()).add(form)
        return max(map(len, forms.values()), default=0) >= SMALLEST_MIXTURE_STUDY


def is_dry_run(words) -> bool:
    """Return whether the words of a command line of Snakemake make it a dry run, such as -n, -np or --dry-run."""
    return any(re.fullmatch(r"-[A-Za-z]*n[A-Za-z]*|--dry-?run", word) for word in words)
