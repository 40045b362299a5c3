"""Checks of a campaign before its first packing: names of studies, shared tables, and heights of beds."""

import re
from pathlib import Path

import pandas as pd

from simcore.campaign import deposits
from simcore.campaign.gathering import table_of
from simcore.evaluation.interval import campaign_cut
from simcore.grains.sources import source_files, source_name
from simcore.packing.forecast import check_bed, check_height_of_bed, typical_grains, with_last_batch
from simcore.paths import ROOT
from simcore.scene.domain import Domain
from simcore.scene.height import check_height
from simcore.scene.identity import deciding_result, differing_keys, with_present_names, without

LEAST_MASS = 0.7  # smallest mass that a number of grains may have, over that of as many typical grains
# `<study>_piece_1` and `<study>_left` are targets of a study, and the others end the names of its tables.
_OF_STUDY = re.compile(r"(.+)_(?:piece_\d+|left|packings|features|trends)")
# For each table that studies share: what distinguishes its rows besides the seed, as keys of a specification.
_DISTINGUISH = {
    "single_form": (("sizes", "case"), ("shapes", "grain"), ("shapes", "kind")),
    "form_mixture": (("sizes", "case"), ("shapes", "flatness"), ("shapes", "elongation")),
}

# Keys in which the packings of a model may differ: seed, form, and the size of the bed.
_OF_FORM = (("seed",), ("shapes", "grain"), ("domain", "width"), ("domain", "height"), ("amount",))


def check_names(studies) -> None:
    """Raise ValueError if the workflow cannot have a study of one of these names."""
    rules = _rule_names()
    for study in studies:
        of_study = _OF_STUDY.fullmatch(study)
        if study in rules or (of_study and of_study[1] in studies):
            raise ValueError(f"studies.{study}: a rule or a table of the workflow has this name; choose another name")
        if study.lower() in ("null", "nan", "none", "na"):
            raise ValueError(f"studies.{study}: tables would read this name as an empty cell; choose another name")
        if study.startswith(deposits.PREFIX):
            deposits.family(study)


def check_committed(cases, path) -> None:
    """Raise ValueError if one of the `cases` has no row in the table of committed packings at `path`, if it exists."""
    if not path.exists():
        return
    available = list(pd.read_csv(path, usecols=["case"])["case"].unique())
    missing = [case for case in cases if case not in available]
    if missing:
        raise ValueError(
            f"models.committed: there are no committed rows of {', '.join(missing)}; choose from "
            f"{', '.join(available)}, or give an empty list"
        )


def check_sources(groups) -> None:
    """Raise ValueError if two of these resolved groups `grains` have other files and one name, by which rows know them.

    groups: one for each set of grains.
    """
    sources = {}
    for group in groups:
        source = group["source"]
        files = [Path(file).resolve() for file in source_files(group)]
        known, known_files = sources.setdefault(source_name(source), (source, files))
        if known_files != files:
            raise ValueError(
                f"grains.source: {known} and {source} have one name, {source_name(source)}, and rows of packings have "
                "only the name; rename one of them"
            )


def _rule_names():
    """Return the names of the rules that are the same in each campaign, as a set."""
    files = [file for file in (ROOT / "workflow").rglob("*") if file.suffix == ".smk" or file.name == "Snakefile"]
    return {name for file in files for name in re.findall(r"(?m)^ *rule (\w+):", file.read_text(encoding="utf-8"))}


def check_shared_tables(packings, studies=()) -> None:
    """Raise ValueError if packings that a shared table does not distinguish differ in another setting than the seed.

    packings: one row per packing, columns study, packing, source and specification. studies: names of those that are
    part of `all`. Of these, the studies of one form share a model too, so that their settings must not differ either.
    """
    first, of_studies = {}, {}
    for row in packings.itertuples():
        keys = _DISTINGUISH.get(table_of(row.study))
        if keys is None:
            continue
        values = [row.specification[group][key] for group, key in keys]
        settings = without(deciding_result(row.specification), (("seed",),))
        other, its_settings = first.setdefault((table_of(row.study), row.source, str(values)), (row, settings))
        if names := differing_keys(*map(with_present_names, (its_settings, settings))):
            both = " and ".join(dict.fromkeys([f"{other.study}/{other.packing}", f"{row.study}/{row.packing}"]))
            raise ValueError(
                f"studies.{row.study}: {both} have the same sieve curve and form and differ in {', '.join(names)}, and "
                "one table and one model would contain both; rename one of these studies, for example to "
                f"my_{row.study}"
            )
        if row.study in studies and table_of(row.study) == "single_form":
            _check_model(row, of_studies)


def _check_model(row, of_studies):
    """Raise ValueError if a packing has other settings than one of another study with the same model.

    of_studies: first packing of each sieve curve and kind of grain so far, with its settings; a new one is added.
    """
    specification = row.specification
    kind = table_of(row.study), row.source, specification["sizes"]["case"], specification["shapes"]["kind"]
    settings = without(deciding_result(specification), _OF_FORM)
    other, its_settings = of_studies.setdefault(kind, (row.study, settings))
    if row.study != other and (names := differing_keys(*map(with_present_names, (its_settings, settings)))):
        raise ValueError(
            f"studies.{row.study}: one model is fitted to its packings and to those of studies.{other}, but they "
            f"differ in {', '.join(names)}; rename one of these studies, for example to my_{row.study}"
        )


def height_option(study: str, specification: dict, cut) -> str:
    """Return the option of `scree launch` with which the height of a bed is checked before it is packed.

    cut: from the campaign's group `porosity`. Deposits are evaluated with cuts of their own and are not checked.
    """
    if study.startswith(deposits.PREFIX):
        return "--force"
    cut = campaign_cut(cut, Domain(**specification["domain"]).periodic)
    return "" if cut is None else f"--cut {cut!r}"


def check_beds(packings, cut=None):
    """Raise ValueError if a bed will be too low for its porosity to be evaluated with this cut, or has no space.

    packings: one row per packing, columns study, packing and specification. cut: from the campaign's group `porosity`.
    """
    for row in packings.itertuples():
        specification = row.specification
        try:
            density, domain = specification["material"]["density"], Domain(**specification["domain"])
            grains = typical_grains(specification)
            # The mass of a number of grains is not known well before they are drawn.
            known = 1.0 if specification["amount"]["mass"] is not None else LEAST_MASS
            check_height(domain, known * density * grains.total, density)
            check_height_of_bed(domain, grains, known * density, specification["generation"])
            check_bed(domain, with_last_batch(grains, specification), density, campaign_cut(cut, domain.periodic))
        except ValueError as error:
            raise ValueError(
                f"studies.{row.study}, packing {row.packing}: {error} To evaluate a lower bed, set porosity.cut."
            ) from None
