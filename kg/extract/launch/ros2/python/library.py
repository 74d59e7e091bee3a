"""All functions that the reader knows, by their last name, or by the full one where another could be meant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.python.conditions import CONDITIONS
from kg.extract.launch.ros2.python.control import CONTROL
from kg.extract.launch.ros2.python.entities import ENTITIES
from kg.extract.launch.ros2.python.events import EVENTS
from kg.extract.launch.ros2.python.includes import INCLUDES
from kg.extract.launch.ros2.python.nodes import NODES
from kg.extract.launch.ros2.python.substitutions import SUBSTITUTIONS
from kg.extract.launch.ros2.python.system import SYSTEM

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Value
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["FUNCTIONS"]

FUNCTIONS: Final[dict[str, Callable[[Call], Value]]] = {
    **SYSTEM,
    **SUBSTITUTIONS,
    **CONDITIONS,
    **INCLUDES,
    **ENTITIES,
    **NODES,
    **EVENTS,
    **CONTROL,
}
