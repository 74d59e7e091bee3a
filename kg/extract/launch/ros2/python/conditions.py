"""The conditions of launch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.values import Choice, Condition, Substitution, Unknown, Words

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Value
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["CONDITIONS", "condition_of"]


def condition_of(call: Call) -> Condition | None:
    """Return the condition of an action; one that is not known is kept in the words of the file."""
    value = call.value("condition")
    if value is None or isinstance(value, Condition):
        return value
    return Condition(None, written=call.words("condition"))


def _predicate(*, negated: bool) -> Callable[[Call], Value]:
    def make(call: Call) -> Value:
        name = "predicate_expression"
        words = call.words(name, 0)
        value = call.value(name, 0)
        if isinstance(value, Unknown | Choice):
            return Condition(None, negated=negated, written=words)
        return Condition(call.text(name, 0) or (), negated=negated, written=words)

    return make


def _configuration(*, negated: bool) -> Callable[[Call], Value]:
    def make(call: Call) -> Value:
        name, expected = call.text("launch_configuration_name", 0) or (), call.text("expected_value", 1) or ()
        test = Substitution("equals", ((Substitution("var", (name, ())),), expected))
        return Condition((test,), negated=negated, written=call.words("", None))

    return make


def _evaluate(call: Call) -> Value:
    """Return `evaluate_condition_expression(context, expression)`."""
    value = call.machine.perform(call.value("expression", 1))
    text = value.strip().lower() if isinstance(value, str) else ""
    if text in {"true", "1"}:
        return True
    if text in {"false", "0"}:
        return False
    return value if isinstance(value, Unknown) else Unknown("a condition is not known")


CONDITIONS: Final[dict[str, Callable[[Call], Value]]] = {
    "IfCondition": _predicate(negated=False),
    "UnlessCondition": _predicate(negated=True),
    "LaunchConfigurationEquals": _configuration(negated=False),
    "LaunchConfigurationNotEquals": _configuration(negated=True),
    "evaluate_condition_expression": _evaluate,
    "perform_substitutions": lambda call: call.machine.perform(call.value("subs", 1)),
    "perform_typed_substitution": lambda call: call.machine.perform(call.value("value", 1)),
    "normalize_to_list_of_substitutions": lambda call: (
        Words(call.text("subs", 0) or (), lazy=True) if call.args else Unknown("nothing is substituted")
    ),
}
