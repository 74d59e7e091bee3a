"""What a master tells of the graph, checked: names that are none are left out and reported."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connection import GraphProblem
from kg.robot.ros1.http import ask, call, exchange, value
from kg.robot.ros1.names import is_name, is_type, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["StateReader", "SystemState", "multicall", "system_state", "topic_types"]

_ROLES = (Role.PUBLISHES, Role.SUBSCRIBES, Role.SERVICES)
_AT_ONCE = 200


@dataclass(frozen=True)
class SystemState:
    """Who publishes, subscribes and serves what: names of nodes by role and name; and what was wrong with the rest."""

    ends: dict[tuple[Role, str], tuple[str, ...]] = field(default_factory=dict)
    problems: tuple[GraphProblem, ...] = ()

    @property
    def nodes(self) -> set[str]:
        """The names of all nodes."""
        return {node for nodes in self.ends.values() for node in nodes}


async def system_state(master: str, caller: str) -> SystemState:
    """Ask a master for its state; RobotError KG810 for an answer that is none, and those of `ask`."""
    return _state(master, await ask(master, "getSystemState", caller))


class StateReader:
    """Asks a master for its state again and again; an answer with the bytes of the one before is not read anew."""

    def __init__(self, master: str, caller: str) -> None:
        self._master = master
        self._caller = caller
        self._content = b""
        self._state = SystemState()

    async def read(self) -> SystemState:
        """Return the state, the very object of the time before where it is the same; errors as `system_state`."""
        content = await exchange(self._master, "getSystemState", self._caller)
        if content != self._content:
            state = _state(self._master, value(self._master, "getSystemState", content))
            self._content = content
            self._state = self._state if state == self._state else state
        return self._state


def _state(master: str, told: Any) -> SystemState:
    ends: dict[tuple[Role, str], tuple[str, ...]] = {}
    problems: dict[GraphProblem, None] = {}
    try:
        for role, rows in zip(_ROLES, told, strict=True):
            for name, nodes in rows:
                for bad in (one for one in (name, *nodes) if not is_name(one)):
                    problems[
                        GraphProblem("KG812", shown(bad), f"it is listed as {role.value}, but is not a ROS name")
                    ] = None
                if is_name(name):
                    ends[role, name] = tuple(sorted({node for node in nodes if is_name(node)}))
    except (TypeError, ValueError):
        raise RobotError("KG810", f"{master} did not report the system state") from None
    return SystemState(ends, tuple(problems))


async def topic_types(master: str, caller: str) -> tuple[dict[str, str], tuple[GraphProblem, ...]]:
    """Ask a master for the types of topics, and return those that are types; errors as those of `system_state`."""
    told = await ask(master, "getTopicTypes", caller)
    try:
        rows = {name: kind for name, kind in told if is_name(name)}
    except (TypeError, ValueError):
        raise RobotError("KG810", f"{master} did not report topic types") from None
    odd = tuple(
        GraphProblem("KG812", name, f"its type `{shown(kind)}` is not a type")
        for name, kind in rows.items()
        if kind != "*" and not is_type(kind)
    )
    return {name: kind for name, kind in rows.items() if is_type(kind)}, odd


async def multicall(master: str, method: str, caller: str, names: list[str]) -> dict[str, Any]:
    """Ask a master the same of many names, and return the values of those that it knows.

    Many calls go in one, as `system.multicall` of XML-RPC, which rosmaster has; of a master without it each is asked.
    """
    found: dict[str, Any] = {}
    for start in range(0, len(names), _AT_ONCE):
        part = names[start : start + _AT_ONCE]
        calls = [{"methodName": method, "params": [caller, name]} for name in part]
        try:
            found |= _values(part, await call(master, "system.multicall", calls))
        except RobotError:
            for name in part:
                try:
                    found[name] = await ask(master, method, caller, name)
                except RobotError as error:
                    if error.code != "KG813":
                        raise
    return found


def _values(names: list[str], told: Any) -> Iterator[tuple[str, Any]]:
    if not isinstance(told, list) or len(told) != len(names):
        raise RobotError("KG810", "a master answers many calls with as many answers")
    for name, answer in zip(names, told, strict=True):
        match answer:
            case [[1, _, value]]:
                yield name, value
            case _:
                continue
