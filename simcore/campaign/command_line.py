"""The options of Snakemake that change a configuration: their values, and the command that has them."""

import shlex

import yaml

# Keys of the configuration on which no result depends.
MACHINE = (
    "ranks",
    "threads",
    "grains_per_rank",
    "cores_per_node",
    "longest_job",
    "compile_first",
    "piece_hours",
    "mpiexec",
)


def typed_values(options):
    """Return the values of `--config`, in which Snakemake makes texts of the numbers and nulls inside of braces.

    options: dict, as from Snakemake; a text that is another value in YAML becomes that value.
    """
    if isinstance(options, dict):
        return {key: typed_values(value) for key, value in options.items()}
    if isinstance(options, list):
        return [typed_values(value) for value in options]
    if not isinstance(options, str):
        return options
    try:
        value = yaml.safe_load(options)
    except yaml.YAMLError:
        return options
    return value if value is None or isinstance(value, bool | int | float) else options


def campaign_command(overlays=(), options=None):
    """Return the command of Snakemake, without a target, whose campaign has the same results.

    overlays: paths of the configurations laid over config.yaml. options: values of `--config`, as from typed_values.
    """
    words = ["snakemake", *(["--configfile", *overlays] if overlays else [])]
    changed = {key: value for key, value in (options or {}).items() if key not in MACHINE}
    texts = [f"{key}={_flow(value)}" for key, value in changed.items()]
    return shlex.join([*words, *(["--config", *texts] if texts else [])])


def _flow(value):
    """Return a value as YAML in one line."""
    text = yaml.safe_dump(value, default_flow_style=True, width=float("inf"), sort_keys=False)
    return text.removesuffix("...\n").strip()
