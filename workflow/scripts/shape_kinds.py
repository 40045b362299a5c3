"""Write the difference in porosity between packings of polyhedra and of their mass-equivalent ellipsoids."""

from simcore.campaign.job_log import log_to
from simcore.reference.named_tables import read_named_table
from simcore.report.models import shape_kind_findings

log_to(snakemake.log[0])
files = snakemake.input
near_spheres = read_named_table(files.near_spheres) if files.near_spheres else None
findings = shape_kind_findings(read_named_table(files.meshes), read_named_table(files.ellipsoids), near_spheres)
findings.write(snakemake.output, snakemake.params.test_only)
