"""A stand-in for rclpy without ROS 2: modules that publish to lists, and messages as strict as ROS 2's.

    python -m robot.programs.rclpy_standin PROGRAM MESSAGE...

runs a program and prints the commands of the robot. As with rclpy, the setters of messages assert that a float is a
float and a whole number an int (`rosidl_generator_py`), nothing is sent after `rclpy.shutdown`, callbacks run in the
executor's thread, and a process that exits while that thread is spinning aborts.
"""

from __future__ import annotations

import atexit
import json
import os
import runpy
import sys
import threading
import time
from functools import partial
from types import ModuleType, SimpleNamespace
from typing import TYPE_CHECKING, Any

from kg.robot.messages import Types

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Node", "message", "modules"]

TYPES = Types(2)
SUCCEEDED = 4
_TEARDOWN = 0.1
"""Seconds that `spin` continues after the end of its context, inside the library and not in Python."""


def message(name: str) -> type:
    """Return a class for a message type of ROS 2."""
    fields = {one.name: one for one in TYPES.fields(name)}

    def begin(self: Any) -> None:
        for field in fields.values():
            object.__setattr__(self, field.name, message(field.type)() if field.is_message else _empty(field.type))

    def put(self: Any, attribute: str, value: object) -> None:
        wanted = type(_empty(fields[attribute].type))
        assert isinstance(value, wanted), f"The '{attribute}' field must be of type '{wanted.__name__}'"
        object.__setattr__(self, attribute, value)

    return type(name.rpartition("/")[2], (), {"__init__": begin, "__setattr__": put})


def _empty(kind: str) -> object:
    return 0.0 if kind.startswith("float") else 0 if "int" in kind else False if kind == "bool" else ""


def _tell(what: str, value: object = None) -> None:
    text = "" if value is None else json.dumps(value, default=vars)
    sys.stdout.write(f"{what} {text}".rstrip() + "\n")
    sys.stdout.flush()


class Library:
    """The state between `rclpy.init` and `rclpy.shutdown`: running, with a spinning executor."""

    def __init__(self) -> None:
        """Start running, with no work."""
        self.running = True
        self.spinning = 0
        self.tasks: list[Callable[[], object]] = []

    def ok(self) -> bool:
        """Whether it is running."""
        return self.running

    def init(self, **_: object) -> None:
        """Register the abort of a process that exits too early."""
        atexit.register(lambda: os.abort() if self.spinning else None)

    def shutdown(self) -> None:
        """Stop sending."""
        self.running = False

    def executor(self) -> SimpleNamespace:
        """Return an executor, which performs pending work until it is shut down."""
        over = threading.Event()

        def spin() -> None:
            self.spinning += 1
            while self.running and not over.wait(0.005):
                for task in self.tasks[:]:
                    self.tasks.remove(task)
                    task()
            time.sleep(_TEARDOWN)
            self.spinning -= 1

        return SimpleNamespace(add_node=lambda _: None, spin=spin, shutdown=over.set)


LIBRARY = Library()


class Future:
    """A future result; the executor calls its callbacks."""

    def __init__(self) -> None:
        """Start waiting."""
        self.callbacks: list[Callable[[Future], object]] = []
        self._result: list[Any] = []

    def done(self) -> bool:
        """Whether the result is available."""
        return bool(self._result)

    def result(self) -> Any:
        """Return the result."""
        return self._result[0]

    def set_result(self, result: object) -> None:
        """Set the result."""
        self._result.append(result)
        LIBRARY.tasks += [partial(callback, self) for callback in self.callbacks]

    def add_done_callback(self, callback: Callable[[Future], object]) -> None:
        """Register a callback for the result."""
        self.callbacks.append(callback)
        if self.done():
            LIBRARY.tasks.append(partial(callback, self))


class ActionClient:
    """A client of a server whose goals never finish; `/late` accepts them only after they were given up."""

    def __init__(self, _: object, __: type, name: str) -> None:
        """Connect."""
        self.name = name

    def wait_for_server(self, _: float) -> bool:
        """Report an available server."""
        return True

    def send_goal_async(self, goal: object) -> Future:
        """Send a goal."""
        _tell("goal", goal)
        sent = Future()

        def cancel() -> None:
            assert LIBRARY.running, "the context is shut down"
            _tell("cancel")

        handle = SimpleNamespace(accepted=True, get_result_async=Future, cancel_goal_async=cancel)

        def accept() -> None:
            if self.name == "/late" and not sent.callbacks:
                LIBRARY.tasks.append(accept)
            else:
                sent.set_result(handle)
                _tell("accepted")

        LIBRARY.tasks.append(accept)
        return sent


class Node:
    """A node whose publishers store their messages by topic."""

    def __init__(self, name: str) -> None:
        """Start without messages."""
        self.name = name
        self.published: dict[str, list[Any]] = {}

    def create_publisher(self, _: type, topic: str, __: int) -> SimpleNamespace:
        """Return a publisher with a subscriber."""
        kept = self.published.setdefault(topic, [])

        def publish(sent: object) -> None:
            assert LIBRARY.running, "the context is shut down"
            kept.append(sent)
            _tell(topic, sent)

        return SimpleNamespace(publish=publish, get_subscription_count=lambda: 1)

    def get_clock(self) -> SimpleNamespace:
        """Return a clock."""
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=time.monotonic_ns()))

    def get_logger(self) -> SimpleNamespace:
        """Return a logger."""
        return SimpleNamespace(info=lambda text: _tell(f"log {text}"))


def modules(*names: str) -> dict[str, ModuleType]:
    """Return the modules imported by code, with messages and actions (`nav2_msgs/action/NavigateToPose`) by name."""
    found: dict[str, dict[str, object]] = {
        "rclpy": {"ok": LIBRARY.ok, "init": LIBRARY.init, "shutdown": LIBRARY.shutdown},
        "rclpy.action": {"ActionClient": ActionClient},
        "rclpy.executors": {"MultiThreadedExecutor": LIBRARY.executor},
        "rclpy.node": {"Node": Node},
        "rclpy.signals": {"SignalHandlerOptions": SimpleNamespace(NO=0)},
        "action_msgs": {},
        "action_msgs.msg": {"GoalStatus": SimpleNamespace(STATUS_SUCCEEDED=SUCCEEDED)},
    }
    for name in names:
        package, *part, kind = name.split("/")
        found.setdefault(package, {})
        module = found.setdefault(f"{package}.{part[0] if part else 'msg'}", {})
        module[kind] = SimpleNamespace(Goal=message(f"{package}/{kind}_Goal")) if part else message(name)
    made = {}
    for name, content in found.items():
        made[name] = ModuleType(name)
        vars(made[name]).update(content)
    return made


if __name__ == "__main__":
    sys.modules.update(modules(*sys.argv[2:]))
    runpy.run_path(sys.argv[1], run_name="__main__")
