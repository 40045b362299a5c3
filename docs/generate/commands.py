"""Page of the commands, from the help of their parsers."""

import argparse

from docs.generate.markdown import code, sentence, table
from simcore.__main__ import command_parser

_HEAD = """# Commands

`scree COMMAND …` is the same as `python -m simcore COMMAND …`. `scree COMMAND --help` prints what this page lists.
The exit status is 0 after success, 1 if a packing failed, and 2 for wrong input, with one line on the mistake.
"""


def parsers():
    """Return the parsers of all commands: dict from the name of a command to its parser and its line of help."""
    (commands,) = (
        action for action in command_parser("scree")._actions if isinstance(action, argparse._SubParsersAction)
    )
    helps = {action.dest: action.help for action in commands._choices_actions}
    return {name: (parser, helps[name]) for name, parser in commands.choices.items()}


def options(parser):
    """Return the arguments and options of a parser, without --help."""
    return [action for action in parser._actions if not isinstance(action, argparse._HelpAction)]


def page():
    """Return the page of the commands."""
    listed = parsers()
    overview = table(
        ["command", "what it does"], [[f"[`{name}`](#{name})", line] for name, (_, line) in listed.items()]
    )
    parts = [_HEAD, overview, "## Without a command", _arguments(options(command_parser("scree")))]
    for name, (parser, line) in listed.items():
        parts += [f"## {name}", sentence(parser.description or line), f"```text\n{_usage(parser)}\n```"]
        parts.append(_arguments(options(parser)))
    return "\n\n".join(filter(None, parts)) + "\n"


def _usage(parser):
    formatter = parser._get_formatter()
    formatter._width = 84
    formatter.add_usage(parser.usage, parser._actions, parser._mutually_exclusive_groups, prefix="")
    return formatter.format_help().strip()


def _arguments(actions):
    rows = []
    for action in actions:
        if isinstance(action, argparse._SubParsersAction):
            continue
        help_text = (action.help or "") % {**vars(action), "prog": "scree"}
        rows.append([_name(action), sentence(help_text), _default(action)])
    if any(default for _, _, default in rows):
        return table(["argument", "meaning", "default"], rows)
    return table(["argument", "meaning"], [[name, meaning] for name, meaning, _ in rows]) if rows else ""


def _name(action):
    if not action.option_strings:
        return code(action.metavar or action.dest)
    value = "" if action.nargs == 0 else f" {_value(action)}"
    return ", ".join(code(f"{option}{value}") for option in action.option_strings)


def _value(action):
    if action.choices and not action.metavar:
        return "{" + ",".join(map(str, action.choices)) + "}"
    return action.metavar or action.dest.upper()


def _default(action):
    if action.nargs == 0 or action.default in (None, False, argparse.SUPPRESS, []):
        return ""
    return code(action.default)
