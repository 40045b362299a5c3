# Models of porosity from the tables of the studies. A model exists only if the campaign has its study.
models, model_figures = [], []
single_form_studies = [name for name in studies if name.startswith("single_form")]

if plan.fits_single_forms:
    models += ["single_form", "single_form_second_features", "single_form_correlations"]
    model_figures += [
        "single_form_features",
        "single_form_zingg",
        "single_form_prediction",
    ]

    rule single_form_models:
        input:
            packings=collect(
                "<results>/tables/{study}_packings.csv", study=single_form_studies
            ),
            committed=branch(
                plan.committed_single_forms is not None,
                then=os.path.relpath(plan.committed_single_forms or "."),
            ),
        output:
            models="<results>/models/single_form.csv",
            correlations="<results>/models/single_form_correlations.csv",
            second_features="<results>/models/single_form_second_features.csv",
            dataset="<results>/models/single_form.nc",
            features=figure("<results>/figures/models/single_form_features", "Models"),
            zingg=figure("<results>/figures/models/single_form_zingg", "Models"),
            prediction=figure(
                "<results>/figures/models/single_form_prediction", "Models"
            ),
        log:
            "<results>/logs/single_form_models.log",
        params:
            seed=campaign["models"]["seed"],
            folds=campaign["models"]["folds"],
            committed=plan.cases_committed,
            test_only=campaign["test_only"],
            code=digest("workflow/scripts/single_form_models.py", *published),
        script:
            "../scripts/single_form_models.py"


if plan.fits_mixtures:
    models += [
        "form_mixture",
        "form_mixture_correlations",
        "form_mixture_feature_sets",
    ]
    model_figures += ["form_mixture_sets", "form_mixture_prediction"]
    models += ["application"] if "application" in studies else []

    rule form_mixture_models:
        input:
            packings="<results>/tables/form_mixtures_features.csv",
            rows="<results>/tables/form_mixtures_packings.csv",
            application=branch(
                "application" in studies,
                then="<results>/tables/application_features.csv",
            ),
        output:
            models="<results>/models/form_mixture.csv",
            correlations="<results>/models/form_mixture_correlations.csv",
            feature_sets="<results>/models/form_mixture_feature_sets.csv",
            dataset="<results>/models/form_mixture.nc",
            sets=figure("<results>/figures/models/form_mixture_sets", "Models"),
            prediction=figure(
                "<results>/figures/models/form_mixture_prediction", "Models"
            ),
            application=branch(
                "application" in studies, then="<results>/models/application.csv"
            ),
        log:
            "<results>/logs/form_mixture_models.log",
        params:
            seed=campaign["models"]["seed"],
            folds=campaign["models"]["folds"],
            test_only=campaign["test_only"],
            code=digest("workflow/scripts/form_mixture_models.py", *published),
        script:
            "../scripts/form_mixture_models.py"


if plan.compares_ellipsoids:
    models += ["shape_kinds"]
    model_figures += ["shape_kinds"]

    rule shape_kinds:
        input:
            meshes="<results>/tables/single_form_packings.csv",
            ellipsoids="<results>/tables/equivalent_ellipsoids_packings.csv",
            near_spheres=branch(
                "near_spheres" in studies, then="<results>/tables/near_spheres.csv"
            ),
        output:
            table="<results>/models/shape_kinds.csv",
            pairs="<results>/models/shape_kind_pairs.csv",
            figure=figure("<results>/figures/models/shape_kinds", "Models"),
        log:
            "<results>/logs/shape_kinds.log",
        params:
            test_only=campaign["test_only"],
            code=digest("workflow/scripts/shape_kinds.py", *published),
        script:
            "../scripts/shape_kinds.py"


# One model for single forms and mixtures, if the campaign has both.
if {"single_form", "form_mixture"} <= set(models):
    models += ["unified", "unified_feature_sets"]

    rule unified_model:
        input:
            single_forms="<results>/tables/single_form_packings.csv",
            mixtures="<results>/tables/form_mixtures_packings.csv",
            features="<results>/tables/form_mixtures_features.csv",
        output:
            models="<results>/models/unified.csv",
            feature_sets="<results>/models/unified_feature_sets.csv",
            dataset="<results>/models/unified.nc",
        log:
            "<results>/logs/unified_model.log",
        params:
            seed=campaign["models"]["seed"],
            folds=campaign["models"]["folds"],
            test_only=campaign["test_only"],
            code=digest("workflow/scripts/unified_model.py", *published),
        script:
            "../scripts/unified_model.py"
