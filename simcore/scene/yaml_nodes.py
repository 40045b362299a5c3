"""Checks of a YAML document before it is read: what YAML allows, but nobody wants in a specification."""

import re

import yaml

MAX_VALUES = 1_000_000  # with all aliases written out; a large campaign has about 10 000
_RESOLVER = yaml.resolver.Resolver()


class UnsuitableYAML(ValueError):
    """The document is valid YAML, but no specification."""


def check_nodes(path, document) -> None:
    """Raise UnsuitableYAML with the line if the composed document of the file at `path` is unsuitable.

    A key occurs twice in a group, of which YAML would use the last one; a number has a leading 0 or a colon, which YAML
    reads as octal or to the base 60; a value has a tag other than !!str; an alias contains itself, or there are more
    than MAX_VALUES values.
    """
    nodes, checked = [document], set()
    while nodes:
        node = nodes.pop()
        if isinstance(node, yaml.ScalarNode):
            _check_tag(path, node)
            _check_number(path, node)
        if not isinstance(node, yaml.CollectionNode) or id(node) in checked:
            continue
        checked.add(id(node))
        if isinstance(node, yaml.SequenceNode):
            nodes += node.value
        else:
            nodes += [part for pair in node.value for part in pair]
            _check_keys(path, node)
    if document is not None and _count(path, document, {}) > MAX_VALUES:
        raise UnsuitableYAML(f"{path}: it has more than {MAX_VALUES} values with all aliases; write fewer of them")


def _check_keys(path, group):
    lines = {}
    for key, _ in group.value:
        if isinstance(key, yaml.ScalarNode):
            line, earlier_line = _line(key), lines.get(key.value)
            if earlier_line is not None:
                raise UnsuitableYAML(
                    f"{path}, line {line}: {key.value} is given in line {earlier_line} already; remove one of them"
                )
            lines[key.value] = line


def _check_tag(path, node):
    without = _RESOLVER.resolve(yaml.ScalarNode, node.value, (node.style is None, node.style is not None))
    if node.tag not in (without, "tag:yaml.org,2002:str"):
        tag = node.tag.replace("tag:yaml.org,2002:", "!!")
        raise UnsuitableYAML(f"{path}, line {_line(node)}: the tag {tag} of {node.value!r} has no use here; remove it")


def _check_number(path, node):
    number = node.tag in ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")
    if not number or node.style is not None:
        return
    if re.fullmatch(r"[-+]?0[0-7_]+", node.value):
        decimal = int(node.value.replace("_", ""))
        raise UnsuitableYAML(
            f"{path}, line {_line(node)}: YAML reads {node.value} as an octal number; write {decimal}, or in quotation "
            "marks if it is text"
        )
    if ":" in node.value:
        raise UnsuitableYAML(
            f"{path}, line {_line(node)}: YAML reads {node.value} as a number to the base 60; write a number, or a "
            "time with its unit"
        )


def _count(path, node, counts):
    """Return the number of values in a node with all aliases written out; counts: of the nodes that were met."""
    if not isinstance(node, yaml.CollectionNode):
        return 1
    if id(node) not in counts:
        counts[id(node)] = None
        parts = node.value if isinstance(node, yaml.SequenceNode) else [part for pair in node.value for part in pair]
        counts[id(node)] = 1 + sum(_count(path, part, counts) for part in parts)
    if counts[id(node)] is None:
        raise UnsuitableYAML(f"{path}, line {_line(node)}: a group contains itself by its alias; write out its values")
    return counts[id(node)]


def _line(node):
    return node.start_mark.line + 1
