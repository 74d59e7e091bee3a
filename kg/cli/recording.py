"""`kg robot nodes`, `kg robot topics` and `kg robot record`: execution and output."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from kg.cli.diagnostics import note
from kg.cli.driving import warn
from kg.cli.interruptible import interruptible
from kg.cli.output import Column, listing
from kg.cli.robot_view import tell_problems
from kg.errors import RobotError
from kg.facts import Role
from kg.render.text import count
from kg.robot.bag.recording import Recorder
from kg.robot.clock import within
from kg.robot.connecting import address_of, connected, inhabited, look
from kg.robot.live.systems import is_implicit

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kg.robot.connection import ComputationGraph
    from kg.settings import Settings

_NODES: Final = (
    Column("node", "name"),
    Column("state"),
    Column("publishes", "number"),
    Column("subscribes", "number"),
    Column("services", "number"),
    Column("actions", "number"),
    Column("where", "dim", spare=2),
    Column("problem", spare=1),
)
_COUNTED: Final = {
    "publishes": Role.PUBLISHES,
    "subscribes": Role.SUBSCRIBES,
    "services": Role.SERVICES,
    "actions": Role.ACTION_SERVERS,
}
_TOPICS: Final = (
    Column("topic", "name"),
    Column("type"),
    Column("publishers", spare=2),
    Column("subscribers", spare=1),
    Column("messages", "number"),
    Column("rate", "number"),
)
_RECORDED: Final = (
    Column("topic", "name"),
    Column("type"),
    Column("messages", "number"),
    Column("dropped", "number", spare=1),
)


def list_nodes(settings: Settings, *, json: bool) -> None:
    """Write the nodes of a robot with their states and their numbers of topics, services and actions."""
    graph = asyncio.run(look(address_of(settings)))
    tell_problems(graph)
    ends = {
        (end.node, end.role, end.name) for end in graph.ends if not is_implicit(end.role, end.name, end.node, graph.ros)
    }
    counts = Counter((node, role) for node, role, _ in ends)
    found = [
        {
            "name": node.name,
            "state": node.state,
            **{title: counts[node.name, role] for title, role in _COUNTED.items()},
            "address": node.address,
            "problem": node.problem,
        }
        for node in graph.nodes
    ]
    listing(_NODES, (tuple(one.values()) for one in found), objects=found if json else None)


def list_topics(settings: Settings, *, json: bool) -> None:
    """Write the topics of a robot, with the numbers of messages for a recording."""
    graph = asyncio.run(look(address_of(settings)))
    tell_problems(graph)
    found = _topics(graph)
    listing(_TOPICS, map(_row, found), objects=found if json else None)


def _topics(graph: ComputationGraph) -> list[dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    recorded = {one.name: one for one in graph.recorded}
    for end in graph.ends:
        if end.role not in {Role.PUBLISHES, Role.SUBSCRIBES}:
            continue
        empty: dict[str, Any] = {"name": end.name, "type": None, "publishers": [], "subscribers": []}
        one = found.setdefault(end.name, {**empty, "messages": None, "rate": None})
        one["type"] = one["type"] or end.type
        nodes = one["publishers" if end.role is Role.PUBLISHES else "subscribers"]
        if end.node not in nodes:
            nodes.append(end.node)
        if (told := recorded.get(end.name)) is not None:
            one["messages"] = told.count
            one["rate"] = round(told.count / told.seconds, 3) if told.seconds else None
    return [found[name] for name in sorted(found)]


def _row(one: dict[str, Any]) -> tuple[object, ...]:
    rate = None if one["rate"] is None else f"{one['rate']:.1f}"
    return one["name"], one["type"], ", ".join(one["publishers"]), ", ".join(one["subscribers"]), one["messages"], rate


def record_topics(settings: Settings, path: Path, topics: Sequence[str], *, keep: float | None, json: bool) -> None:
    """Record topics until Ctrl-C, SIGTERM, `keep` seconds or the end of the robot; then write the file's content.

    Raises as `Recorder`; RobotError KG803 when the robot is lost, KG825 if no message arrived within `keep` seconds.
    """
    interruptible(_record(settings, path, topics, keep=keep, json=json))


async def _record(settings: Settings, path: Path, topics: Sequence[str], *, keep: float | None, json: bool) -> None:
    address = address_of(settings)
    async with connected(address) as connection:
        await inhabited(connection)
        recorder = Recorder(
            connection,
            path,
            topics=frozenset(topics) or None,
            tell=lambda topic, kind: note(f"recording {topic} ({kind})"),
            on_problem=lambda one: warn(one, json=False),
        )
        try:
            work = recorder.run()
            await (work if keep is None else within(connection.clock, keep, work))
        except TimeoutError:
            pass
        finally:
            done = recorder.close()
            listing(
                _RECORDED,
                [(one.topic, one.type, one.messages, one.dropped) for one in done],
                objects=map(asdict, done) if json else None,
            )
            number = sum(one.messages for one in done)
            if number:
                note(f"{count(number, 'message')} in {recorder.last - recorder.first:.1f} s: {path}")
        if not number:
            raise RobotError("KG825", "no message came, so that no file was written")
