"""Files that the catalogue of workflows and Zenodo read, and the workflow without the Snakefile at the root."""

import json

import pytest
import yaml

from simcore.paths import ROOT


@pytest.mark.workflow
def test_both_snakefiles_plan_the_same(workplace):
    smoke = ["--configfile", "config/smoke.yaml"]
    jobs = sorted(workplace.plan(*smoke), key=str)
    assert ("all", None) in jobs and len(jobs) > 50
    (workplace.folder / "Snakefile").unlink()
    assert sorted(workplace.plan(*smoke), key=str) == jobs  # Snakemake finds workflow/Snakefile by itself
    # Whoever deploys the workflow includes it as a module, without the file at the root.
    (workplace.folder / "Snakefile").write_text(
        'configfile: "config/config.yaml"\n\nmodule scree:\n    snakefile: "workflow/Snakefile"\n    config: config\n\n'
        "use rule * from scree\n"
    )
    status, said = workplace.run("--dry-run", *smoke, "--", "all")
    assert status == 0, said


def test_the_catalogue_finds_its_files():
    settings = yaml.safe_load((ROOT / ".snakemake-workflow-catalog.yml").read_text(encoding="utf-8"))
    assert settings["usage"].keys() == {"mandatory-flags", "software-stack-deployment", "report"}
    assert (ROOT / "workflow/Snakefile").is_file()
    assert len((ROOT / "config/README.md").read_text(encoding="utf-8")) > 500


def test_the_readme_of_the_configuration_names_each_file():
    text = (ROOT / "config/README.md").read_text(encoding="utf-8")
    for path in (ROOT / "config").glob("*.*"):
        assert f"`{path.name}`" in text or path.name == "README.md", path.name


def test_zenodo_and_citation_agree():
    zenodo = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert zenodo["title"] == citation["title"] and zenodo["license"] == citation["license"]
    assert [creator["name"] for creator in zenodo["creators"]] == [author["name"] for author in citation["authors"]]
    assert zenodo["related_identifiers"][0]["identifier"] == citation["references"][0]["doi"]
