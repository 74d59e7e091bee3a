"""What xacro prints where a launch file asks for it: the plugins of the description, kept for the parameter it goes to.

The text itself is not computed; it stays unknown.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.locate import find
from kg.extract.launch.xacro.plugins import Descriptions, mappings_of
from kg.names import normalise

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.extract.launch.ros2.context import Context, Found
    from kg.facts import LaunchPlugin, StartedNode

__all__ = ["describe", "described", "is_xacro"]

_RUN: Final = ["ros2", "run", "xacro"]


def is_xacro(words: Sequence[str]) -> bool:
    """Tell whether a command line is one of xacro."""
    words = _program(words)
    return len(words) > 1 and words[0].rpartition("/")[2] in {"xacro", "xacro.py"}


def describe(context: Context, words: Sequence[str]) -> None:
    """Keep the plugins of the description that a command line of xacro names, for the parameter that is given it."""
    words = _program(words)
    named = next((word for word in words[1:] if not word.startswith("-") and ":=" not in word), None)
    file = find(context, named) if named is not None else None
    if file is None:
        return
    descriptions = Descriptions(context.files, context.stack[0], context.initial)
    read = descriptions.read(file, mappings_of(words[1:]), (*context.chain, context.location))
    for problem in read.problems:
        context.found.problems.setdefault(problem)
    for one in read.files:
        context.found.files.setdefault(one)
    context.found.printed = read.plugins


def _program(words: Sequence[str]) -> Sequence[str]:
    return words[len(_RUN) :] if list(words[: len(_RUN)]) == _RUN else words


def described(found: Found, nodes: Iterable[StartedNode]) -> Iterator[LaunchPlugin]:
    """Yield the plugins in the parameters of nodes, each with the absolute name of its parameter."""
    for node in nodes:
        name = node.name or (node.executable or "{}").removesuffix(".py")
        for given in node.parameters:
            held = found.described.get((given.name, given.location, given.chain), ())
            absolute = normalise(f"{node.namespace}/{name}/{given.name}")
            yield from (replace(plugin, parameter=absolute) for plugin in held)
