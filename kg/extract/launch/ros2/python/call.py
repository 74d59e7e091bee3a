"""One call of a function that the reader of launch files knows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.extract.launch.expressions import call

if TYPE_CHECKING:
    from kg.extract.launch.ros2.python.invoke import Invocations

__all__ = ["Call"]


@dataclass(frozen=True, slots=True)
class Call(call.Call):
    """A call in a launch file, which may read files and run functions of the build."""

    machine: Invocations
