"""Conversion of programs to Python code without kg: a node for ROS 1 (rospy) or ROS 2 (rclpy)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from kg.robot.programs.check import kinds_of, refuse_errors
from kg.robot.programs.converting.code import Dialect, Names
from kg.robot.programs.converting.members import Members
from kg.robot.programs.converting.node import module
from kg.robot.programs.converting.statements import Code
from kg.robot.programs.names import CapabilityIndex

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.errors import Place
    from kg.robot.capability import Capabilities
    from kg.robot.programs.tree import Program

__all__ = ["convert"]

_METHODS = ("now", "check", "sleep", "until", "ends", "together", "as_soon_as", "whenever", "run", "connect", "halt")
_OF_SIGNALS = ("on_signal", "over", "status", "wait")
_OF_A_NODE = (
    "local",
    "deadline",
    "handle",
    "context",
    "executor",
    "clients",
    "publishers",
    "services",
    "subscriptions",
)
_IN_METHODS = ("seconds", "within", "end", "request", "response", "sent", "result", "answer", "handle", "error", "math")


def convert(
    program: Program,
    capabilities: Capabilities,
    *,
    to: Literal["rospy", "rclpy"] = "rospy",
    place: Callable[[str], Place] | None = None,
) -> str:
    """Return a Python file that does the same as a program, through the interfaces of a robot's capabilities.

    `place` returns the place of a part of the program in its file.

    Raises:
        RobotError: the first error of an invalid program; KG839 for parts without generated code.
    """
    refuse_errors(program, capabilities, place)
    names = Names(*_METHODS, *_OF_SIGNALS, *_OF_A_NODE, *_IN_METHODS)
    members = Members(Dialect(to), names)
    code = Code(members, CapabilityIndex(capabilities), kinds_of(program, capabilities), program, place)
    run = code.sequence(program.body, "/body")
    return module(program, members, code.used, run)
