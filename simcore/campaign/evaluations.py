"""Whether the evaluation of a packing belongs to the settings that its campaign has now."""

import json
from pathlib import PurePath

from simcore.evaluation.interval import campaign_cut
from simcore.scene.identity import deciding_result, differing_keys, with_present_names

SETTINGS = "porosity_settings"  # attribute of an evaluation: the campaign's group `porosity`, as JSON


def settings_text(porosity: dict) -> str:
    """Return the text of a campaign's group `porosity` that an evaluation keeps."""
    return json.dumps(porosity, sort_keys=True)


def grain_set_of(specification: dict) -> str:
    """Return the name of the grain set of a packing of a campaign, which has a digest of its files; "" without one."""
    source = specification.get("grains", {}).get("source")
    parts = PurePath(source).parts if isinstance(source, str) else ()
    return parts[-2] if len(parts) > 2 and parts[-3] == "grains" else ""


def how_it_differs(evaluation, specification: dict, porosity: dict | None = None) -> str:
    """Return in words how an evaluation differs from what a campaign plans, or "" if it does not.

    evaluation: Dataset of simcore.evaluation.evaluate, or fabric, with the scene in its attributes. specification:
    resolved, of the plan. porosity: the campaign's group `porosity`; None: it does not matter. An evaluation that does
    not state its settings is of an earlier version, and counts as equal in them.
    """
    scene = json.loads(evaluation.attrs["scene"])
    planned, packed = (with_present_names(deciding_result(each)) for each in (specification, scene))
    if keys := differing_keys(planned, packed):  # a key that is missing counts as null
        return f"was packed with another value of {', '.join(keys)}"
    if grain_set_of(specification) != grain_set_of(scene):
        return "was packed with other grains"
    stated = evaluation.attrs.get(SETTINGS)
    if porosity is not None and stated is not None:
        periodic = specification["domain"]["type"] == "periodic"
        ours, its = ({**group, "cut": campaign_cut(group["cut"], periodic)} for group in (porosity, json.loads(stated)))
        if keys := differing_keys(ours, its, "porosity."):
            return f"was evaluated with another value of {', '.join(keys)}"
    return ""


def check_evaluations(study: str, paths, evaluations, specifications, porosity: dict | None = None) -> None:
    """Raise ValueError if one of a study's evaluations does not belong to the settings that the study has now.

    paths, evaluations, specifications: one per packing, in the same order; they and porosity are as for how_it_differs.
    """
    for path, evaluation, planned in zip(paths, evaluations, specifications, strict=True):
        if differs := how_it_differs(evaluation, planned, porosity):
            raise ValueError(
                f"studies.{study}: {path} {differs} than the study has now, so that one table would have beds of "
                "different settings. Give the command again without `--rerun-triggers`: Snakemake then makes it anew"
            )
