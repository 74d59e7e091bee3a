"""The conditions of launch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.python.values import Made
from kg.extract.launch.ros2.texts import Condition, Substitution
from kg.symbolic.values import Either, Unknown

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["CONDITIONS", "condition", "condition_on"]

CONDITIONS: Final[Mapping[str, tuple[str, ...]]] = {
    "IfCondition": ("predicate_expression",),
    "UnlessCondition": ("predicate_expression",),
    "LaunchConfigurationEquals": ("launch_configuration_name", "expected_value"),
    "LaunchConfigurationNotEquals": ("launch_configuration_name", "expected_value"),
}
"""The names of the parameters of each condition, in order."""


def condition_on(made: Made) -> Condition | None:
    """Return the condition of an action; one that is not known is kept in the words of the file."""
    value = made.value("condition")
    if value is None:
        return None
    if isinstance(value, Made) and value.name in CONDITIONS:
        return condition(value)
    return Condition(None, written=made.words("condition"))


def condition(made: Made) -> Condition:
    """Return what an object of a condition stands for."""
    negated = made.name.startswith(("Unless", "LaunchConfigurationNot"))
    name, *expected = CONDITIONS[made.name]
    held = made.value(name)
    if isinstance(held, Unknown | Either):
        return Condition(None, negated=negated, written=made.words(name))
    if not expected:
        return Condition(made.text(name) or (), negated=negated, written=made.words(name))
    operands = (Substitution("var", (made.text(name) or (), ())),), made.text(expected[0]) or ()
    return Condition((Substitution("equals", operands),), negated=negated, written=made.words(""))
