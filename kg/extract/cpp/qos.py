"""Quality of service of one end of a ROS 2 interface, as the code spells it.

Source: rclcpp/qos.hpp and rmw/qos_profiles.h for the profiles that have names.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.values import Number
from kg.facts import Qos

if TYPE_CHECKING:
    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.unit import Expr

__all__ = ["read_qos"]

_PROFILES: Final = {
    "SensorDataQoS": Qos("best_effort", "volatile", "keep_last", 5),
    "rmw_qos_profile_sensor_data": Qos("best_effort", "volatile", "keep_last", 5),
    "ServicesQoS": Qos("reliable", "volatile", "keep_last", 10),
    "rmw_qos_profile_services_default": Qos("reliable", "volatile", "keep_last", 10),
    "ParametersQoS": Qos("reliable", "volatile", "keep_last", 1000),
    "SystemDefaultsQoS": Qos(),
    "rmw_qos_profile_default": Qos("reliable", "volatile", "keep_last", 10),
}


def read_qos(evaluator: Evaluator, where: Expr, context: Context) -> Qos | None:
    """Return the quality of service that an argument stands for; None where nothing of it is known."""
    node = syntax.unwrap(where.node)
    if node.type == "number_literal":
        for value, _ in evaluator.values(where, context):
            if isinstance(value, Number):
                return Qos("reliable", "volatile", "keep_last", int(value.value))
    if node.type in ("identifier", "qualified_identifier"):
        return _PROFILES.get(syntax.simple_name(node))
    return None
