"""All generated pages of the documentation site."""

from docs.generate import columns, commands, papers, python_names, results, settings, size_and_form


def pages():
    """Return the generated pages: dict from their paths below docs/ to their text in Markdown."""
    return {
        "reference/packing_settings.md": settings.packing_page(),
        "reference/campaign_settings.md": settings.campaign_page(),
        "reference/sieve_curves.md": settings.curves_page(),
        "reference/commands.md": commands.page(),
        "reference/python.md": python_names.page(),
        "reference/columns.md": columns.page(),
        "reference/results.md": results.page(),
        "reference/papers.md": papers.page(),
        "reference/size_and_form.md": size_and_form.page(),
    }
