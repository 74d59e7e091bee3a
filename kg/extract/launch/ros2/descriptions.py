"""What xacro prints where a launch file asks for it: the plugins of the description, kept for the parameter it goes to.

The text itself is not computed; it stays unknown.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kg.extract.launch.ros2.locate import find
from kg.extract.launch.xacro.plugins import Descriptions, named_description, started
from kg.holes import ANONYMOUS
from kg.names import normalise

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.extract.launch.ros2.context import Context, Found
    from kg.facts import LaunchPlugin, StartedNode

__all__ = ["describe", "described"]


def describe(context: Context, words: Sequence[str]) -> None:
    """Keep the plugins of the description that a command line prints, for the parameter that is given it."""
    named = named_description(started(words))
    file = find(context, named[0]) if named is not None else None
    if named is None or file is None:
        return
    descriptions = Descriptions(context.files, context.stack[0], context.initial)
    read = descriptions.read(file, named[1], (*context.chain, context.location))
    for problem in read.problems:
        context.found.problems.setdefault(problem)
    for one in read.files:
        context.found.files.setdefault(one)
    context.found.printed = read.plugins


def described(found: Found, nodes: Iterable[StartedNode]) -> Iterator[LaunchPlugin]:
    """Yield the plugins in the parameters of nodes, each with the absolute name of its parameter."""
    names = {name for name, _, _ in found.described}
    for node in nodes:
        for given in node.parameters:
            if given.name in names:
                name = node.name or (node.executable or ANONYMOUS).removesuffix(".py")
                absolute = normalise(f"{node.namespace}/{name}/{given.name}")
                held = found.described.get((given.name, given.location, given.chain), ())
                yield from (replace(plugin, parameter=absolute) for plugin in held)
