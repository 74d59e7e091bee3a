"""Nodes that run behavior trees: those with a parameter that names a file of trees, or nodes that these make for it.

Rows `tree` of `ontology/plugins.toml` list them; its head explains them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.facts import TREE_NODE, Role, StartKind
from kg.holes import is_known
from kg.launch.wiring.behavior_trees import is_tree, nodes_of
from kg.launch.wiring.instances import Draft
from kg.launch.wiring.place import Place
from kg.launch.wiring.plugin_table import rows
from kg.launch.wiring.remapping import rules_of
from kg.launch.wiring.values import shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.facts import DataFile, Interface, NodeType, StartedNode
    from kg.launch.wiring.types import NodeTypes

_SCHEME: Final = "package:"
"""Begins the names of installed files; most values need not be parsed."""
_UNKNOWN: Final = "no parameter names a behavior tree that is in the sources"


@dataclass(frozen=True, slots=True)
class _Runner:
    """A row of the table; its head explains the fields."""

    ros: int
    source: str
    code: tuple[str, ...]
    package: str
    name: str


def run_trees(drafts: Sequence[Draft], types: NodeTypes) -> Iterator[Draft]:
    """Yield the nodes with the trees that they run, each followed by those that it makes to run others."""
    lines = {draft.place.full: draft.started for draft in drafts}
    for draft in drafts:
        yield draft
        for node in [one[1] for one in (draft.typed, *(plugin.found for plugin in draft.plugins)) if one is not None]:
            files = dict(_files(draft, node, types))
            made = [(row, one) for row in rows("tree", _Runner) if row.ros == draft.ros for one in _actions(row, node)]
            for row, action in made:
                inner = _made(row, action, draft, lines)
                own = [file for parameter, file in files.items() if len(made) == 1 or _beside(parameter, action, node)]
                _give(inner, own, types)
                yield inner
            if not made and (files or any(slot.base_class == TREE_NODE for slot in node.slots)):
                _give(draft, list(files.values()), types)


def _actions(row: _Runner, node: NodeType) -> Iterator[Interface]:
    for one in node.interfaces:
        places = (one.location, *one.via)
        if one.role is Role.ACTION_SERVERS and is_known(one.name) and any(p.path.endswith(row.code) for p in places):
            yield one


def _beside(parameter: str, action: Interface, node: NodeType) -> bool:
    """Return whether a parameter and an action server are of the same class, by the names of their files."""
    stems = {PurePosixPath(one.location.path).stem for one in node.parameters if one.name == parameter}
    return PurePosixPath(action.location.path).stem in stems


def _files(draft: Draft, node: NodeType, types: NodeTypes) -> Iterator[tuple[str, DataFile]]:
    """Yield the files with trees that parameters of a node type name as they are set, or by default."""
    given = {name.removeprefix(f"{draft.place.full}/"): one.value for name, one in draft.set_here}
    for parameter in node.parameters:
        name = (parameter.name or "").removeprefix("~/")
        value = given.get(name, parameter.default)
        path = shown(value) if value is not None and _SCHEME in value else None
        file = types.data_file(path) if path is not None else None
        if file is not None and is_tree(file):
            yield parameter.name or "", file


def _made(row: _Runner, action: Interface, maker: Draft, lines: dict[str, StartedNode]) -> Draft:
    """Return the node that is made for an action server; it has the command line of its maker's process."""
    process = maker.started.host or maker.place.full
    name = row.name.replace("{node}", maker.place.name).replace("{action}", (action.name or "").replace("/", "_"))
    line = lines.get(process)
    started = replace(
        maker.started,
        name=name,
        kind=StartKind.INNER,
        package=row.package,
        executable=None,
        plugin=None,
        remaps=tuple(one for one in line.remaps if not one.source.startswith("__")) if line is not None else (),
        parameters=(),
        arguments=(),
        settings=(("made-by", maker.place.full),),
    )
    place = Place(maker.place.namespace, name)
    rules = rules_of(started.remaps, place, maker.ros)
    return Draft(started, place, maker.ros, None, None, None, rules, process=process, repository=maker.repository)


def _give(draft: Draft, files: list[DataFile], types: NodeTypes) -> None:
    draft.tree_nodes += (node for file in files for node in nodes_of(file, types))
    if not files:
        draft.reason = draft.reason or _UNKNOWN
