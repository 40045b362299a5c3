"""`scree schema packing`: the JSON Schema of a YAML file, for editors."""

import json


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "schema",
        help="print the keys of a YAML file as JSON Schema, for editors",
        description="Print all keys of the YAML file of a packing or of a campaign, with descriptions and defaults, as "
        "JSON Schema. An editor uses it if the first line of a YAML file is: "
        "# yaml-language-server: $schema=FILE",
    )
    parser.add_argument("name", choices=("packing", "config"), help="file of a packing, or of a campaign")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the schema and return 0."""
    from simcore.scene.editor_schema import editor_schema

    print(json.dumps(editor_schema(options.name), indent=1, ensure_ascii=False))
    return 0
