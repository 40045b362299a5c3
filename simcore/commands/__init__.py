"""The subcommands of the command line, one module each.

A module of COMMANDS has `add(commands)`, which adds the parser of its command to what argparse's `add_subparsers`
returned and sets `run` to the function that carries it out: it takes the parsed options and returns the exit status.
What takes long to import is imported in that function, so that every command starts fast and needs only its own
libraries.
"""

# In the order of the help text.
COMMANDS = (
    "explain",
    "pack",
    "compile",
    "launch",
    "porosity",
    "fabric",
    "pores",
    "predict",
    "fit",
    "page",
    "sieve",
    "export",
    "plot",
    "compare",
    "watch",
    "schema",
)
