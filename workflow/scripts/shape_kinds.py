"""How far packings of grains and of their mass-equivalent ellipsoids differ in porosity."""

import pandas as pd

from simcore.figures.models import shape_kind_figure
from simcore.figures.saving import save_figure
from simcore.model_tables import shape_kind_table
from simcore.reference import read_study_table
from simcore.study_tables import mark, pair_shape_kinds

test_only = snakemake.params.test_only
meshes, ellipsoids = (pd.read_csv(path) for path in (snakemake.input.meshes, snakemake.input.ellipsoids))
pairs = pair_shape_kinds(meshes, ellipsoids)
table = shape_kind_table(pairs, read_study_table("mesh_ellipsoid_difference"))
near_spheres = pd.read_csv(snakemake.input.near_spheres) if snakemake.input.near_spheres else None
mark(pairs, test_only).to_csv(snakemake.output.pairs, index=False)
mark(table, test_only).to_csv(snakemake.output.table, index=False)
save_figure(shape_kind_figure(pairs, near_spheres), snakemake.output.figure, test_only)
