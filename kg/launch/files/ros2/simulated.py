"""Managers of controllers that run in a simulator: plugins in robot descriptions, with parameter files of their own.

`ontology/simulation.toml` lists them (rows `manager`). They are there only if a program of the configuration hands a
description to a simulator, as descriptions of real robots have these plugins as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from kg.facts import LaunchPlugin, Remap, StartedNode, StartKind
from kg.launch.files.ros2.context import HOLE, Context, GlobalFile
from kg.launch.files.ros2.parameters import Owner, node_parameters
from kg.launch.wiring.simulation_table import manager_of, spawner_of
from kg.names import normalise

_ROS: Final = 2


def managers(context: Context, nodes: Iterable[StartedNode], plugins: Sequence[LaunchPlugin]) -> Iterator[StartedNode]:
    """Yield the managers that plugins of robot descriptions are, each one once."""
    rows = [(plugin, row) for plugin in plugins if (row := manager_of(plugin.library, _ROS)) is not None]
    if not rows or not any(spawner_of(node.package, node.executable, _ROS) for node in nodes):
        return
    seen: set[str] = set()
    for plugin, row in rows:
        texts = {one.element: one.text for one in reversed(plugin.values)}
        name = next((texts[element] for element in row.name if texts.get(element)), row.named)
        namespace = normalise(f"/{texts.get(row.namespace, '')}")
        if f"{namespace}/{name}" in seen or HOLE in name + namespace:
            continue
        seen.add(f"{namespace}/{name}")
        files = [
            GlobalFile(one.text, one.location, plugin.chain)
            for one in plugin.values
            if one.element == row.parameters and HOLE not in one.text
        ]
        rules = ((*one.text.partition(":="), one) for one in plugin.values if one.element == row.remapping)
        yield StartedNode(
            name=name,
            namespace=namespace,
            kind=StartKind.INNER,
            location=plugin.location,
            chain=plugin.chain,
            package=row.package,
            plugin=plugin.name,
            remaps=tuple(
                Remap(source.strip(), target.strip(), one.location, plugin.chain)
                for source, mark, target, one in rules
                if mark
            ),
            parameters=node_parameters(context, Owner(namespace, name), files),
            condition=plugin.condition,
        )
