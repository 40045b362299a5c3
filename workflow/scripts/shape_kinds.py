"""How far packings of grains and of their mass-equivalent ellipsoids differ in porosity."""

import pandas as pd

from simcore.campaign.study_tables import mark
from simcore.models.shape_kinds import pair_shape_kinds, shape_kind_table
from simcore.reference.r22_tables import read_study_table
from simcore.report.figures.models import shape_kind_figure
from simcore.report.figures.saving import save_figure

test_only = snakemake.params.test_only
meshes, ellipsoids = (pd.read_csv(path) for path in (snakemake.input.meshes, snakemake.input.ellipsoids))
pairs = pair_shape_kinds(meshes, ellipsoids)
table = shape_kind_table(pairs, read_study_table("mesh_ellipsoid_difference"))
near_spheres = pd.read_csv(snakemake.input.near_spheres) if snakemake.input.near_spheres else None
mark(pairs, test_only).to_csv(snakemake.output.pairs, index=False)
mark(table, test_only).to_csv(snakemake.output.table, index=False)
save_figure(shape_kind_figure(pairs, near_spheres), snakemake.output.figure, test_only)
