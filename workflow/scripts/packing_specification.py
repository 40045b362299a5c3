"""The complete specification of one packing, with the name of its grain."""

import csv
from pathlib import Path

import yaml

from simcore.campaign.studies import choose_form
from simcore.scene.specification import express

(specification,), (form,) = snakemake.params.specification, snakemake.params.form
names = []
if form:
    (forms,) = snakemake.input.forms
    with open(forms, newline="", encoding="utf-8") as file:
        names = [line["grain"] for line in csv.DictReader(file)]
text = yaml.safe_dump(express(choose_form(specification, form, names)), sort_keys=False, allow_unicode=True)
Path(snakemake.output.specification).write_text(text, encoding="utf-8")
