"""Scree: porosity of gravel from the form of its grains.

Data flow one way: grain -> scene -> packing -> porosity -> model.

    grains/          what a grain is: scans, hulls, mass-equivalent ellipsoid, form factors, sieve curves, beta sizes
    dem/             what moves: shapes, contacts, force laws, time steps, the packing process
    specification    what a user writes, checked against config/*.schema.yaml, in SI units
    scenes           a specification and its grains become a scene of the core
    explanation      what a scene computes, what it will cost, how far its limits are
    launch           the ranks of a packing under a watchdog outside MPI
    keeping          when a packing under way is kept; checkpoint: the files it is kept in
    packing_io       a packing and its netCDF file
    porosity         n(z), bulk porosity and its sampling error
    slicing          exact solid volume of grains between horizontal planes
    segregation      size, form and orientation over height
    fabric           of the bulk, its density, contacts (coordination, contact_radius) and directions
    deposits         fabrics of a study of ellipsoids as tables; deposit_findings: where they are densest
    work_precision   tables of error against run time, their Pareto front
    verification/    the parts of the core against closed forms: error and CPU time
    regression       form features, cross-validation, fitted porosity models
    collection       rows of finished packings in committed tables; campaign_cost: hours and pieces of studies
    unified_model    one model for beds of one form and for distributions of form
    prediction       porosity of measured grains (measured_forms), without packing them
    report           the page of a campaign, of its packings or of committed rows alone; formulas: its models in short
    figures/         every picture, as functions that return a Figure

`python -m simcore explain SPEC.yaml` says what a packing will do, `pack SPEC.yaml OUT.nc` runs it, `launch` does on
several ranks, `porosity OUT.nc` and `fabric OUT.nc ...` evaluate it, `predict FORMS.csv` says what the fitted models
make of measured grains.
"""

__version__ = "0.1.0"
