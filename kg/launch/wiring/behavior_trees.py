"""Behavior trees: their nodes, from the XML files that parameters of nodes name.

A file that includes others, and subtrees in them or in other files of its folder, are followed (BehaviorTree.CPP 3
and 4). The nodes of a tree are plugins of `BT::TreeNode`, by the names under which C++ registers them; a port has the
value that the XML gives it, which in a subtree can be one of the subtree's own ports.

Nodes that run behavior trees: those with a parameter that names a file of trees, or nodes that these make for it.

Rows `tree` of `ontology/plugins.toml` list them; its head explains them.
"""

from __future__ import annotations

import json
import posixpath
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.facts import TREE_NODE, DataFile, Interface, LaunchParameter, Location, NodeType, Role, StartedNode, StartKind
from kg.holes import is_known
from kg.launch.wiring.instances import Draft
from kg.launch.wiring.place import Place
from kg.launch.wiring.plugin_table import rows
from kg.launch.wiring.remapping import rules_of
from kg.launch.wiring.values import shown
from kg.xmltext import line_of, parse_xml

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from lxml.etree import _Element

    from kg.launch.wiring.types import NodeTypes, Typed

_TYPED: Final = ("Action", "Condition", "Control", "Decorator")
"""Elements that have the name of the node as `ID`."""
_SUBTREES: Final = ("SubTree", "SubTreePlus")
_OWN: Final = ("ID", "name")
_MOST_DEPTH: Final = 20
_BLACKBOARD: Final = "it is an entry of the blackboard"

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
        for node in [one[1] for one in (draft.typed, *(plugin.typed for plugin in draft.plugins)) if one is not None]:
            files = dict(_files(draft, node, types))
            runs = [(row, one) for row in rows("tree", _Runner) if row.ros == draft.ros for one in _actions(row, node)]
            for row, action in runs:
                inner = _inner_draft(row, action, draft, lines)
                own = [file for parameter, file in files.items() if len(runs) == 1 or _is_near(parameter, action, node)]
                _give(inner, own, types)
                yield inner
            if not runs and (files or any(slot.base_class == TREE_NODE for slot in node.slots)):
                _give(draft, list(files.values()), types)


def _actions(row: _Runner, node: NodeType) -> Iterator[Interface]:
    for one in node.interfaces:
        places = (one.location, *one.via)
        if one.role is Role.ACTION_SERVERS and is_known(one.name) and any(p.path.endswith(row.code) for p in places):
            yield one


def _is_near(parameter: str, action: Interface, node: NodeType) -> bool:
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


def _inner_draft(row: _Runner, action: Interface, maker: Draft, lines: dict[str, StartedNode]) -> Draft:
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


@dataclass(frozen=True, slots=True)
class _Use:
    """An element of a tree: the name of the node, or of the subtree, with its ports as text."""

    name: str
    ports: tuple[tuple[str, str], ...]
    line: int
    subtree: bool


@dataclass(frozen=True, slots=True)
class _Trees:
    """The trees of a file by name, the main one, and the files that it includes, as `package://` or relative paths."""

    main: str | None
    uses: Mapping[str, tuple[_Use, ...]]
    includes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TreeNode:
    """A node of a tree that an instance runs, with the ports that its element gives; `element` is its identity."""

    typed: Typed
    ports: Mapping[str, LaunchParameter]
    element: LaunchParameter


def is_tree(file: DataFile | None) -> bool:
    """Check whether a file has behavior trees."""
    return file is not None and file.path.endswith(".xml") and bool(_read(file.text).uses)


def nodes_of(file: DataFile, types: NodeTypes) -> Iterator[TreeNode]:
    """Yield the nodes of the main tree of a file that the build has, each use of one."""
    own = _read(file.text)
    if own.main is not None:
        yield from _of_tree(own.main, file, {}, types, ())


def _of_tree(
    name: str, file: DataFile, given: Mapping[str, str | None], types: NodeTypes, above: tuple[str, ...]
) -> Iterator[TreeNode]:
    home = _home(name, file, types, ())
    if home is None or name in above or len(above) > _MOST_DEPTH:
        return
    for use in _read(home.text).uses[name]:
        # A port names an entry of the blackboard in braces: in a subtree, one of the subtree's own ports.
        ports = {
            port: (given.get(text[1:-1].strip()) if text.startswith("{") and text.endswith("}") else text)
            for port, text in use.ports
        }
        if use.subtree:
            yield from _of_tree(use.name, home, ports, types, (*above, name))
            continue
        typed = types.tree_node(use.name, home.repository)
        if typed is not None:
            place = Location(home.path, use.line, home.repository)
            yield TreeNode(
                typed,
                {port: _setting(f"{use.name}.{port}", value, place) for port, value in ports.items()},
                LaunchParameter(use.name, json.dumps(use.name), place),
            )


def _setting(name: str, value: str | None, place: Location) -> LaunchParameter:
    if value is None:
        return LaunchParameter(name, None, place, reason=_BLACKBOARD)
    return LaunchParameter(name, json.dumps(value), place, type="string")


def _home(name: str, file: DataFile, types: NodeTypes, seen: tuple[str, ...]) -> DataFile | None:
    """Return the file with a tree: this one, one that it includes, or another one of its folder."""
    own = _read(file.text)
    if name in own.uses:
        return file
    folder = posixpath.dirname(file.path)
    for path in own.includes:
        whole = path if "://" in path else f"package://{file.package}/{posixpath.normpath(f'{folder}/{path}')}"
        other = types.data_file(whole)
        if other is not None and other.path not in seen:
            home = _home(name, other, types, (*seen, file.path))
            if home is not None:
                return home
    siblings = (one for one in types.data(file.package) if posixpath.dirname(one.path) == folder and is_tree(one))
    return next((one for one in siblings if name in _read(one.text).uses), None)


@lru_cache(maxsize=256)
def _read(text: str) -> _Trees:
    root = parse_xml(text.encode()).root
    if root is None or root.tag != "root":
        return _Trees(None, {}, ())
    uses = {
        tree.get("ID") or "": tuple(_use(one) for one in tree.iterdescendants("*"))
        for tree in root.iter("BehaviorTree")
    }
    main = root.get("main_tree_to_execute") or next(iter(uses), None)
    includes = tuple(
        f"package://{one.get('ros_pkg')}/{one.get('path')}" if one.get("ros_pkg") else one.get("path", "")
        for one in root.iter("include")
    )
    return _Trees(main, uses, includes)


def _use(element: _Element) -> _Use:
    tag = str(element.tag)
    named = tag in _TYPED or tag in _SUBTREES
    ports = tuple((str(key), str(value)) for key, value in element.attrib.items() if key not in _OWN)
    return _Use(element.get("ID", "") if named else tag, ports, line_of(element), tag in _SUBTREES)
