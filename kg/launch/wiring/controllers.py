"""Controllers, named by programs other than their manager: of `ros_control` (ROS 1) and `ros2_control` (ROS 2).

In ROS 1 they are plugins of the node that loads them, with parameters below no node (`loader` in the table). In ROS 2
each is a node of its own in the process of the manager (rows `spawner`), whose parameters tell its class.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.facts import StartKind
from kg.launch.wiring.inner_nodes import Inner
from kg.launch.wiring.instances import Draft, draft_of
from kg.launch.wiring.plugin_table import rows
from kg.launch.wiring.plugins import Framework, Loaded, table
from kg.launch.wiring.values import Server, shown
from kg.names import normalise

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.launch.wiring.types import NodeTypes

_TYPE: Final = "/type"


@dataclass(frozen=True, slots=True)
class _Spawner:
    """A row of the table; its head explains the fields."""

    ros: int
    source: str
    package: str
    executable: tuple[str, ...]
    manager: tuple[str, ...]
    named: str
    kind: tuple[str, ...]
    valued: tuple[str, ...]
    first: tuple[str, ...] = ()


def with_controllers(drafts: Sequence[Draft], types: NodeTypes) -> Iterator[Draft]:
    """Yield the nodes, and after them the controllers that spawners ask their managers for (ROS 2)."""
    yield from drafts
    by_name = {draft.place.full: draft for draft in drafts}
    created: set[str] = set()
    for draft in drafts:
        row = next((row for row in rows("spawner", _Spawner) if _is_of(row, draft)), None)
        if row is None:
            continue
        options, names = _read(row, draft.started.arguments)
        manager = by_name.get(draft.place.resolve(next((options[o] for o in row.manager if o in options), row.named)))
        if manager is None:
            continue
        given = next((options[option] for option in row.kind if option in options), None)
        for name in names:
            full = f"{manager.place.namespace}/{name}"
            kind = given or _kind_of(name, manager)
            if kind is not None and full not in created:
                created.add(full)
                yield _controller(name, kind, manager, draft, types)


def _is_of(row: _Spawner, draft: Draft) -> bool:
    started = draft.started
    return (row.ros, row.package) == (draft.ros, started.package) and started.executable in row.executable


def _read(row: _Spawner, arguments: Sequence[str]) -> tuple[dict[str, str], list[str]]:
    """Return the options of a spawner that have a value, and the names of controllers."""
    options, names = {}, []
    words = iter([word for argument in arguments for word in argument.split()])
    for word in words:
        if word == "--ros-args":
            break
        option, given, value = word.partition("=")
        if option in (*row.manager, *row.kind, *row.valued):
            options[option] = value if given else next(words, "")
        elif not word.startswith("-"):
            names.append(word)
    if row.first:
        names = names[1:] if names and names[0] in row.first else []
    return options, names


def _kind_of(name: str, manager: Draft) -> str | None:
    """Return the class that the parameters of a manager give to a controller."""
    wanted = f"{manager.place.full}/{name}.type"
    return next((shown(given.value) for full, given in manager.set_here if full == wanted), None)


def _controller(name: str, kind: str, manager: Draft, spawner: Draft, types: NodeTypes) -> Draft:
    """Return the node of a controller; it gets the parameter files of its manager."""
    line = manager.written or manager.started
    started = replace(
        line,
        name=name,
        namespace=manager.place.namespace,
        kind=StartKind.INNER,
        location=spawner.started.location,
        chain=spawner.started.chain,
        package=kind.replace("::", "/").partition("/")[0],
        executable=None,
        plugin=kind,
        remaps=tuple(one for one in line.remaps if not one.source.startswith("__")),
        arguments=(),
        settings=(("made-by", manager.place.full),),
    )
    draft = draft_of(started, types, manager.repository, manager.ros, Inner((), manager.ros, name, "", ""))
    draft.process = manager.place.full
    return draft


def attach(drafts: Sequence[Draft], server: Server, types: NodeTypes) -> None:
    """Give each plugin that starters name to the first node that can load it; without such a node it is left out."""
    for framework in table().values():
        loader = next((draft for draft in drafts if _loads(draft, framework)), None) if framework.loader else None
        if loader is None:
            continue
        for scope, identifier in dict.fromkeys(_wanted(drafts, framework)):
            given = server.all.get(normalise(f"{scope}/{identifier}{_TYPE}"))
            kind = shown(given.value) if given is not None else None
            typed = types.plugin(kind, loader.repository) if kind is not None else None
            if kind is not None and (typed is None or typed[1].base_class == framework.base):
                loader.plugins.append(Loaded(identifier, kind, scope, typed, framework, f"{identifier}{_TYPE}"))


def _wanted(drafts: Sequence[Draft], framework: Framework) -> Iterator[tuple[str, str]]:
    """Yield the namespaces and ids that the arguments of starters name."""
    for draft in drafts:
        if draft.started.package in framework.starter:
            for argument in draft.started.arguments:
                for word in argument.split():
                    if not word.startswith("-"):
                        yield draft.place.namespace, word


def _loads(draft: Draft, framework: Framework) -> bool:
    started = draft.started
    if f"{started.package}/{started.executable}" in framework.loader:
        return True
    return draft.typed is not None and any(slot.base_class == framework.base for slot in draft.typed[1].slots)
