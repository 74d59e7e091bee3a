"""Handlers of events: their actions become groups, under a condition where it cannot be known that the event comes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.values import Condition, Function, Unknown
from kg.extract.launch.ros2.actions import Action, Executable, Group, NodeAction
from kg.extract.launch.ros2.python.conditions import condition_of
from kg.extract.launch.ros2.python.flatten import actions_of
from kg.extract.launch.ros2.python.values import IGNORED
from kg.holes import ANONYMOUS

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Value
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["EVENTS"]


def _handler(what: str, *names: str, certain: bool = False) -> Callable[[Call], Value]:
    """Return the maker of a handler; `names` are its arguments with actions."""

    def make(call: Call) -> Value:
        if call.path.endswith("OnShutdown"):
            return IGNORED  # what is done at the end is no part of the system
        given = call.first(*names)
        value = call.again(given, [Unknown("an event"), Unknown("a context")]) if isinstance(given, Function) else given
        actions = tuple(actions_of(call.machine, value, call.location))
        subject = _subject(call.first("target_action", "target_lifecycle_node"))
        condition = None if certain else Condition(None, written=f"{what} {subject}".strip())
        return Group(location=call.location, condition=condition, actions=actions, scoped=False)

    return make


def _subject(value: Value) -> str:
    """Return what an event is about, for the words of the condition."""
    if isinstance(value, NodeAction):
        texts = value.name or value.executable or ()
    elif isinstance(value, Executable):
        texts = value.command[0] if value.command else ()
    else:
        return ""
    return "".join(part if isinstance(part, str) else ANONYMOUS for part in texts)


def _register(call: Call) -> Value:
    value = call.value("event_handler", 0)
    if not isinstance(value, Group):
        return value if isinstance(value, Action | Unknown) else IGNORED
    if not value.actions:
        return IGNORED
    condition = condition_of(call)
    if condition is None:
        return value
    return Group(location=call.location, condition=condition, actions=(value,), scoped=False)


EVENTS: Final[dict[str, Callable[[Call], Value]]] = {
    "RegisterEventHandler": _register,
    "OnProcessStart": _handler("on start of", "on_start", certain=True),
    "OnExecutionComplete": _handler("on completion of", "on_completion", certain=True),
    "OnProcessExit": _handler("on exit of", "on_exit"),
    "OnProcessIO": _handler("on output of", "on_stdout", "on_stderr", "on_stdin"),
    "OnShutdown": _handler("on shutdown", "on_shutdown"),
    "OnStateTransition": _handler("on a transition of", "entities"),
    "OnActionEventBase": _handler("on an event of", "on_event"),
    "EventHandler": _handler("on an event", "entities", "entity"),
}
