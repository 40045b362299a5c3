"""Columns of the tables that only the report page has, simcore.report.answers."""

from simcore.reference.columns.column import Column

PAGE = (
    # Formulas of the models
    Column("kind_of_bed", "", "beds of one form, or with a distribution of form"),
    Column("source", "", "name of the grains' source"),
    Column("formula", "", "porosity by the model"),
    Column("fitted_range", "", "range of the forms to which the model was fitted"),
    Column("r22_formula", "", "porosity by the model of Rettinger et al. (2022)"),
    # Examples
    Column("example", "", "form of all grains of the bed, in words"),
    Column("porosity_*", "", "porosity of this sieve curve by our model; after ±: standard deviation about the model"),
    # Packings of a campaign compared with committed ones
    Column("study_title", "", "title of the study"),
    Column("compared", "", "number of settings that both campaigns have"),
    Column("own_n", "", "mean porosity of these settings, packings of this campaign"),
    Column("committed_n", "", "mean porosity of these settings, committed packings"),
    Column("difference", "", "own minus committed"),
    Column("difference_std_error", "", "standard error of the difference, from the sampling errors"),
    # Effects of settings on the porosity of one study
    Column("of", "", "what differs: settings, size of the bed, time of shaking or insertion"),
    Column("effect", "", "difference in porosity, measured on other packings; in brackets: what was compared"),
)
