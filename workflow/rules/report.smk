# Static page of all tables and figures.


rule report:
    input:
        tables=collect("results/tables/{study}.csv", study=studies),
        models=collect("results/models/{model}.csv", model=models),
    output:
        report="results/report.html",
    log:
        "results/logs/report.log",
    params:
        titles=titles,
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/report.py"),
    script:
        "../scripts/report.py"
