"""The computation graph that a launch configuration makes, resolved from facts alone."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kg.facts import LaunchConfiguration, Location, NodeInstance, StartedNode, System
from kg.launch.wiring.behavior_trees import run_trees
from kg.launch.wiring.controllers import attach, with_controllers
from kg.launch.wiring.inner_nodes import started_inner, started_other
from kg.launch.wiring.instances import Draft, draft_of, finished, loads
from kg.launch.wiring.similar_names import near_misses
from kg.launch.wiring.simulation import simulate
from kg.launch.wiring.values import Server

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.launch.wiring.types import NodeTypes


def wire(configuration: LaunchConfiguration, types: NodeTypes) -> System:
    """Return the instances that a configuration starts, with resolved names, in the order of its nodes.

    A pure function: the same facts give the same system. Names are resolved as the client libraries of the
    configuration's version of ROS do; what cannot be known stays unknown, with the reason.
    """
    repository, ros = configuration.repository, configuration.ros
    drafts = [draft_of(started, types, repository, ros) for started in configuration.nodes]
    if ros != 1:
        drafts = list(with_controllers(_with_inner(drafts, configuration.nodes, types), types))
    server = Server(configuration.parameters) if ros == 1 else None
    shared: list[str] = []
    if server is not None:
        of, shared = server.shared_out(draft.place.full for draft in drafts)
        for draft in drafts:
            draft.set_here = [(name, server.all[name]) for name in of.get(draft.place.full, ())]
    for draft in drafts:
        loads(draft, types)
    if server is not None:
        attach(drafts, server, types)
    drafts = list(run_trees(drafts, types))
    simulate(drafts, configuration)
    by_name = {draft.place.full: draft for draft in reversed(drafts)}
    instances_by_index: dict[int, NodeInstance] = {}
    # Guests first: what they use of the rules of their manager or maker counts as used by it.
    for index in sorted(range(len(drafts)), key=lambda at: _line_of(drafts[at]) is None):
        draft = drafts[index]
        instances_by_index[index] = finished(draft, server, by_name.get(_line_of(draft) or ""))
    used = {rule.location for draft in drafts for rule in draft.used}
    instances = tuple(_without_shared(instances_by_index[index], used) for index in range(len(drafts)))
    return System(
        configuration=configuration,
        instances=instances,
        similar=near_misses(instances, ros),
        shared_parameters=tuple(server.all[name] for name in shared) if server is not None else (),
    )


def _line_of(draft: Draft) -> str | None:
    """Return the name of the process with the command line of a node that has none of its own."""
    return draft.process or draft.started.host


def _with_inner(drafts: Sequence[Draft], nodes: Sequence[StartedNode], types: NodeTypes) -> list[Draft]:
    """Return the nodes, each followed by those that it makes; these get the command line of the whole process."""
    lines = {draft.place.full: started for draft, started in zip(drafts, nodes, strict=True)}
    result = []
    for draft, started in zip(drafts, nodes, strict=True):
        result.append(draft)
        process = started.host or draft.place.full
        for row in draft.makes:
            node = started_inner(row, started, draft.place, lines.get(process))
            inner = draft_of(node, types, draft.repository, draft.ros, row)
            inner.process = process
            result.append(inner)
        for name in draft.others:
            node = started_other(name, started, draft.place)
            other = draft_of(node, types, draft.repository, draft.ros)
            other.process = process
            result.append(other)
    return result


def _without_shared(instance: NodeInstance, used: set[Location]) -> NodeInstance:
    """Return the instance without guesses for remappings shared by several nodes that match another one."""
    if not any(rule.similar and rule.remap.location in used for rule in instance.remaps):
        return instance
    remaps = (replace(rule, similar=()) if rule.remap.location in used else rule for rule in instance.remaps)
    return replace(instance, remaps=tuple(remaps))
