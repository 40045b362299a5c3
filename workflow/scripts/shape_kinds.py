"""Write the difference in porosity between packings of polyhedra and of their mass-equivalent ellipsoids."""

import pandas as pd

from simcore.campaign.job_log import log_to
from simcore.report.models import shape_kind_findings

log_to(snakemake.log[0])
files = snakemake.input
near_spheres = pd.read_csv(files.near_spheres) if files.near_spheres else None
findings = shape_kind_findings(pd.read_csv(files.meshes), pd.read_csv(files.ellipsoids), near_spheres)
findings.write(snakemake.output, snakemake.params.test_only)
