"""Nodes that a node makes itself in its process, as `controller_server` makes its costmap.

Launch files do not name them, yet their command line reaches them: parameter files with sections of their own, and
remappings. Rows `inner` of `ontology/plugins.toml` list the nodes that make others; its head explains them.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING

from kg.facts import Interface, LaunchParameter, NodeType, StartedNode, StartKind
from kg.holes import ANONYMOUS, anonymous, filled, is_partial
from kg.launch.wiring.plugin_table import rows
from kg.names import is_for_node, normalise

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.launch.wiring.place import Place
    from kg.launch.wiring.types import Typed


@dataclass(frozen=True, slots=True)
class Inner:
    """A row of the table; its head explains the fields."""

    of: tuple[str, ...]
    ros: int
    name: str
    type: str
    source: str
    below: str = ""
    code: tuple[str, ...] = ()
    outside: tuple[str, ...] = ()
    named: tuple[str, ...] = ()
    defaults: Mapping[str, str] = field(default_factory=dict)
    each: bool = False
    unless: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Spelling:
    """How the names of a type's interfaces change in a node that is made under another name.

    `own` is the name that the type gives itself, `name` that of the node, `ids` those of the plugins that have
    interfaces of their own, whose names are open in the type.
    """

    row: Inner
    own: str
    name: str
    ids: tuple[str, ...] = ()

    def names(self, declared: Interface) -> tuple[str, ...] | None:
        """Return the names that an interface has here; None where it keeps its own."""
        if declared.name in self.row.outside:
            return ()
        if declared.implicit or declared.parameter is not None:
            return None
        for pattern in self.row.named:
            if declared.name == pattern.replace("{name}", self.own):
                return (pattern.replace("{name}", self.name),)
            if declared.name is not None and anonymous(declared.name) == pattern.replace("{name}", ANONYMOUS):
                return ()
        pattern = declared.name or ANONYMOUS
        return tuple(filled(pattern, one) for one in self.ids) if self.row.each and is_partial(pattern) else None


def inner_nodes(typed: Typed | None) -> tuple[Inner, ...]:
    """Return the rows of nodes that a node of a type makes."""
    if typed is None:
        return ()
    reference, node = typed
    return tuple(row for row in _makers().get(f"{reference.package}/{reference.node}", ()) if row.ros == node.ros)


def without_inner(node: NodeType, inner: Iterable[Inner]) -> NodeType:
    """Return a node type without the code of the nodes that it makes."""
    rows_of = list(inner)
    code = tuple(path for row in rows_of for path in row.code)
    outside = {name for row in rows_of for name in row.outside}
    if not code:
        return node
    return replace(
        node,
        interfaces=tuple(one for one in node.interfaces if one.name in outside or not one.location.path.endswith(code)),
        parameters=tuple(one for one in node.parameters if not one.location.path.endswith(code)),
    )


def other_nodes(started: StartedNode, node: NodeType) -> tuple[str, ...]:
    """Return the names of the further nodes of a program; a name that is given to it is that of all of them."""
    named = started.name or any(rule.source in ("__node", "__name") for rule in started.remaps)
    if named or node.node_name is None or started.kind not in (StartKind.NODE, StartKind.LIFECYCLE_NODE):
        return ()
    names = dict.fromkeys(one.node for one in node.interfaces if one.node is not None)
    return tuple(name for name in names if name != node.node_name)


def of_own_node(node: NodeType, name: str | None) -> NodeType:
    """Return a node type with the interfaces of one node of its program; None is the first. All have its parameters."""
    names = (name,) if name is not None else (None, node.node_name)
    own = (one for one in node.interfaces if one.node in names or (one.node is None and one.implicit))
    return replace(node, interfaces=tuple(own))


def started_other(name: str, first: StartedNode, place: Place) -> StartedNode:
    """Return a further node of the program of a started one."""
    return replace(first, name=name, kind=StartKind.INNER, settings=(("made-by", place.full),))


def started_inner(row: Inner, maker: StartedNode, place: Place, process: StartedNode | None) -> StartedNode:
    """Return an inner node of `maker` as a started node; `process` has the command line, if known.

    It shares the container of its maker, which is among its settings as `made-by`.
    """
    package, _, executable = row.type.partition("/")
    return replace(
        maker,
        name=row.name,
        namespace=normalise(f"{place.namespace}/{row.below}"),
        kind=StartKind.INNER,
        package=package,
        executable=executable,
        plugin=None,
        remaps=tuple(one for one in process.remaps if not one.source.startswith("__")) if process is not None else (),
        parameters=process.parameters if process is not None else (),
        arguments=(),
        settings=(("made-by", place.full),),
    )


def addressed(parameters: Iterable[LaunchParameter], full: str, *, alone: bool = True) -> Iterator[LaunchParameter]:
    """Yield those of a process's parameters that are for its node `full`; their values are unknown where that is.

    What is written for no key is for the node that the launch file starts: not for another one, for which not `alone`.
    """
    for given in parameters:
        if given.node is None:
            if alone:
                yield given
            continue
        sure = is_for_node(given.node, full)
        if sure:
            yield replace(given, node=None)
        elif sure is None:
            doubtful = f"it is for the node `{given.node}`, if this one is called so"
            yield replace(given, node=None, value=None, reason=doubtful)


def filled_defaults(row: Inner, place: Place) -> dict[str, str | None]:
    """Return the defaults of an inner node's parameters that its maker sets, as YAML."""
    above = place.namespace.removesuffix(f"/{row.below}").rstrip("/") if row.below else place.namespace.rstrip("/")
    return {name: value.replace("{above}", above) for name, value in row.defaults.items()}


@cache
def _makers() -> dict[str, list[Inner]]:
    by_maker: dict[str, list[Inner]] = {}
    for row in rows("inner", Inner):
        for maker in row.of:
            by_maker.setdefault(maker, []).append(row)
    return by_maker
