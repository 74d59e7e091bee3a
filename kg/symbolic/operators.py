"""Operators over abstract values: arithmetic, comparisons, and conditions with the guards that they imply."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from kg.facts import Resolution
from kg.symbolic.durations import scaled
from kg.symbolic.letters import computed
from kg.symbolic.values import (
    Bound,
    Closure,
    Either,
    Enumerator,
    Guard,
    Mapping,
    Number,
    Object,
    Sequence,
    Text,
    Truth,
    TypeValue,
    Unknown,
    Value,
    alternatives,
    as_text,
    concatenate,
    is_foreign,
    join,
    number,
    without_default,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.symbolic.form import Literal

NULL: Final = Unknown("it is null")
_COMPUTED: Final = Unknown("it is computed when the program runs")
_NEGATED: Final = {"==": "!=", "!=": "==", "<": ">=", ">": "<=", "<=": ">", ">=": "<"}
COUNT: Final = re.compile(r"argc(==|!=|>=|<=|>|<)(.+)")
"""A term of a guard about the number of arguments of the command line: its sign and the number."""
_NOT_NULL: Final = (Object, Text, Number, Truth, Sequence, Mapping, TypeValue, Closure, Bound)
_MIRRORED: Final = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}
_WORD: Final = re.compile(r"[\w./+-]+")
_LARGEST_EXPONENT: Final = 64
_LONGEST: Final = 5_000
"""How many letters or items the repetition of a text or a list has at most."""
_ARITHMETIC: Final[dict[str, Callable[[float, float], float]]] = {
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "true/": lambda a, b: a / b,
    "//": lambda a, b: a // b,
    "%": math.fmod,
    "**": lambda a, b: a**b if abs(b) < _LARGEST_EXPONENT else float("nan"),
    "|": lambda a, b: float(int(a) | int(b)),
    "&": lambda a, b: float(int(a) & int(b)),
    "<<": lambda a, b: float(int(a) << int(b)) if b < _LARGEST_EXPONENT else float("nan"),
}


def literal(expression: Literal) -> Value:
    """Return the value of a literal."""
    constant = expression.value
    if isinstance(constant, str):
        return Text((constant,))
    if isinstance(constant, bool):
        return Truth(constant)
    return NULL if constant is None else Number(constant, expression.written)


def chosen(operands: Iterable[Callable[[], Value]], *, all_of: bool) -> Value:
    """Return the operand that `and` or `or` of Python gives, or the condition that they are together.

    Of operands that are not certain, `or` can give each, `and` only the last, since the others are then empty.
    """
    seen: list[Value] = []
    uncertain: list[Value] = []
    for operand in operands:
        seen.append(operand())
        condition = truth(seen[-1])
        if not isinstance(condition, Truth):
            uncertain.append(seen[-1])
        elif condition.value != all_of:
            break
    if all(isinstance(value, (Truth, Guard, Unknown)) and value != NULL for value in seen):
        return logical((partial(_same, value) for value in seen), all_of=all_of)
    if all_of:
        return seen[-1]
    text = any(isinstance(one, Text) for one in alternatives(seen[-1]))
    return join(*(_without_empty(value, text=text) for value in uncertain), seen[-1])


def _same(value: Value) -> Value:
    return value


def under(value: Value, terms: Iterable[str]) -> Value:
    """Return a value where terms of guards hold: a parameter that they say is not empty has no empty default there."""
    if isinstance(value, Text) and value.exact == "" and value.parameter is not None and value.parameter in terms:
        return Text.hole(f"the parameter {value.parameter} is empty by default", parameter=value.parameter)
    return value


def _without_empty(value: Value, *, text: bool) -> Value:
    """Return a parameter whose default is empty as one without default, and an unknown value as an unknown `text`."""
    if text and isinstance(value, Unknown) and value.parameter is None and value != NULL:
        return as_text(value)
    if isinstance(value, Text) and value.exact == "":
        return Unknown(f"the parameter {value.parameter} is empty by default", value.parameter)
    return value


def compute(sign: str, row: tuple[Value, ...]) -> Value:
    """Return the result of an operator on values without alternatives."""
    if sign in _NEGATED:
        return _compared(sign, row)
    if sign == "in":
        return _contained(row[0], row[1])
    if sign == "|" and any(isinstance(value, Mapping) for value in row):
        mappings = [value for value in row if isinstance(value, Mapping)]
        merged = {key: (key, value) for one in mappings for key, value in one.items}
        return Mapping(tuple(merged.values()), open=len(mappings) < len(row) or any(one.open for one in mappings))
    duration = scaled(sign, row)
    if duration is not None:
        return duration
    letter = computed(sign, row) if sign in ("+", "-") else None
    if letter is not None:
        return letter
    if sign == "+":
        return _sum(row)
    if sign in ("/", "true/") and any(isinstance(value, Text) for value in row):
        parts: list[Value] = [row[0]]
        for value in row[1:]:
            parts += [Text.of("/"), value]
        return concatenate(*parts)
    if sign == "*" and isinstance(row[-1], Number) and isinstance(row[0], (Text, Sequence)):
        return _repeated(row[0], row[-1].whole)
    numbers = [value for value in row if isinstance(value, Number)]
    if len(numbers) != len(row):
        return _COMPUTED
    whole = not any(value.floating for value in numbers)
    result = numbers[0].value
    for other in numbers[1:]:
        try:
            result = _ARITHMETIC[sign](result, other.value)
            if sign == "/" and whole:
                result = float(math.trunc(result))
        except (KeyError, ZeroDivisionError, OverflowError, TypeError, ValueError):
            return _COMPUTED
    if not math.isfinite(result):
        return _COMPUTED
    return _number(result, numbers, whole=whole and sign != "true/")


def _number(value: float, of: list[Number], *, whole: bool) -> Number:
    """Return a number that was computed of others."""
    parameter = next((one.parameter for one in of if one.parameter), None)
    return number(value, parameter) if whole else Number(value, repr(float(value)), parameter)


def _repeated(of: Text | Sequence, times: int) -> Value:
    size = len(of.items) if isinstance(of, Sequence) else len(of.exact or "")
    if size * max(times, 0) > _LONGEST:
        return _COMPUTED
    if isinstance(of, Sequence):
        return replace(of, items=of.items * times)
    return replace(of, parts=(of.exact * times,), own=False) if of.exact is not None else _COMPUTED


def _sum(row: tuple[Value, ...]) -> Value:
    numbers = [value for value in row if isinstance(value, Number)]
    if len(numbers) == len(row):
        return _number(
            sum(value.value for value in numbers), numbers, whole=not any(value.floating for value in numbers)
        )
    lists = [value for value in row if isinstance(value, Sequence)]
    if len(lists) == len(row):
        return Sequence(tuple(item for value in lists for item in value.items), any(value.open for value in lists))
    return concatenate(*row) if any(isinstance(value, Text) for value in row) else Unknown("it is computed")


def _contained(item: Value, container: Value) -> Value:
    """Check whether a container or a text has an item."""
    if isinstance(container, Text) and isinstance(item, Text):
        if container.exact is not None and item.exact is not None and container.parameter is None:
            return Truth(item.exact in container.exact)
    elif isinstance(container, (Sequence, Mapping)) and not container.open and container.parameter is None:
        keys = container.items if isinstance(container, Sequence) else [key for key, _ in container.items]
        comparisons = [_compared("==", (item, key)) for key in keys]
        if Truth(True) in comparisons:
            return Truth(True)
        if all(one == Truth(False) for one in comparisons):
            return Truth(False)
    return Unknown("it depends on a value", getattr(container, "parameter", None))


def _compared(sign: str, row: tuple[Value, ...]) -> Value:
    left, right = row[0], row[-1]
    parameter: str | None = next((v for v in (getattr(v, "parameter", None) for v in row) if v), None)
    if parameter == "argc" and isinstance(right, Number):
        return Guard((f"argc{sign}{right.written}",))
    if parameter is not None:
        left, right = row = _numbered(left), _numbered(right)
        constant = next((v for v in row if isinstance(v, Truth) and v.parameter is None), None)
        if sign in ("==", "!=") and constant is not None:
            return Guard((parameter if constant.value == (sign == "==") else f"!{parameter}",))
        if sign in ("==", "!=") and any(isinstance(v, Text) and v.exact == "" and v.parameter is None for v in row):
            return Guard((f"!{parameter}" if sign == "==" else parameter,))
        for value, choice, way in ((left, right, sign), (right, left, _MIRRORED.get(sign, sign))):
            if _is_whole(value, parameter) and _is_choice(choice, way):
                term = f"{parameter} {'==' if way == '!=' else way} {plain(choice)}"
                return Guard((negated_term(term) if way == "!=" else term,))
        return Unknown("it depends on a parameter", parameter)
    if isinstance(left, Guard) and right == number(0) and sign in ("==", "!="):
        return negate(left) if sign == "==" else left
    if sign in ("==", "!="):
        if right == NULL and (left == NULL or isinstance(left, _NOT_NULL)):
            holds = Truth(False) if left == NULL else truth(left) if isinstance(left, Object) else Truth(True)
            return Truth(holds.value == (sign == "!=")) if isinstance(holds, Truth) else holds
        if isinstance(left, (Enumerator, TypeValue)) and type(left) is type(right):
            return Truth((left == right) == (sign == "=="))
        if is_foreign(left) and is_foreign(right):
            return Truth((left == right) == (sign == "=="))
        if isinstance(left, Sequence) and isinstance(right, Sequence):
            return _alike(left, right, sign)
    if any(isinstance(value, Text) and value.unsure for value in (left, right)):
        return Unknown("it depends on a comparison")
    if Text.of("") in row and any(isinstance(value, Text) and value.given_name for value in row):
        return Truth(sign != "==")
    one, other = plain(left), plain(right)
    mixed = isinstance(one, str) is not isinstance(other, str)
    if one is None or other is None or (mixed and sign not in ("==", "!=")):
        return Unknown("it depends on a comparison")
    if sign in ("==", "!="):
        return Truth((one == other) == (sign == "=="))
    if isinstance(one, str) and isinstance(other, str):
        return Truth(_ordered(sign, (one > other) - (one < other)))
    return Truth(_ordered(sign, float(one) - float(other)))


def _numbered(value: Value) -> Value:
    """Return the number of an enumerator, and any other value as it is."""
    return number(value.number) if isinstance(value, Enumerator) and value.number is not None else value


def _is_choice(value: Value, sign: str) -> bool:
    """Check whether a value is a constant for a switch: a number, or a word if the sign is that of equality."""
    if isinstance(value, Text) and sign in ("==", "!="):
        return value.parameter is None and value.exact is not None and _WORD.fullmatch(value.exact) is not None
    return isinstance(value, Number) and value.parameter is None


def _is_whole(value: Value, parameter: str) -> bool:
    """Check whether a value is that of a parameter, not one made of it."""
    if isinstance(value, Unknown):
        return value == without_default(parameter)
    if isinstance(value, Text) and value.resolution is Resolution.LAUNCH_ARGUMENT:
        return len(value.parts) == 1 and value.exact is None  # an argument of the command line
    return isinstance(value, (Text, Number)) and value.own and value.parameter == parameter


def _ordered(sign: str, difference: float) -> bool:
    """Check an order by the sign of the difference of its sides."""
    if sign in ("<", "<="):
        return difference < 0 or (sign == "<=" and difference == 0)
    return difference > 0 or (sign == ">=" and difference == 0)


def _alike(left: Sequence, right: Sequence, sign: str) -> Value:
    """Check whether two lists are equal."""
    pairs = zip(left.items, right.items, strict=False)
    comparisons = {Truth(len(left.items) == len(right.items)), *(_compared("==", pair) for pair in pairs)}
    if left.open or right.open or not comparisons <= {Truth(True), Truth(False)}:
        return Unknown("it depends on a comparison")
    return Truth((Truth(False) not in comparisons) == (sign == "=="))


def plain(value: Value) -> str | float | bool | None:
    """Return a text, number or truth value as Python has it; None for what is not wholly known."""
    if isinstance(value, Text):
        return value.exact
    if isinstance(value, Number):
        return value.value if value.floating or value.value != value.value // 1 else int(value.value)
    return value.value if isinstance(value, Truth) else None


def logical(operands: Iterable[Callable[[], Value]], *, all_of: bool) -> Value:
    """Return the conjunction or disjunction of conditions, evaluated until one decides."""
    conditions: list[Truth | Guard | Unknown] = []
    for operand in operands:
        condition = truth(operand())
        if not isinstance(condition, Truth):
            conditions.append(condition)
        elif condition.value != all_of:
            return condition
    if not conditions:
        return Truth(all_of)
    # A disjunction is the opposite of the conjunction of the opposites.
    terms = dict.fromkeys(term for one in conditions for term in (terms_of if all_of else opposite_terms)(one))
    whole = all(
        isinstance(one, Guard) and one.whole and (len(one.terms) == 1 or one.any_of != all_of) for one in conditions
    )
    return _guard(tuple(terms), whole=whole, opposite=not all_of)


def _guard(terms: tuple[str, ...], *, whole: bool, opposite: bool = False) -> Guard | Unknown:
    """Return the conjunction of terms or its opposite as a guard."""
    if not terms:
        return Unknown("it depends on a condition")
    alone = len(terms) == 1 and whole
    return Guard(tuple(map(negated_term, terms)), whole, not alone) if opposite else Guard(terms, whole)


def truth(value: Value) -> Truth | Guard | Unknown:
    """Return a value as a condition: `Truth` if it is known, `Guard` if it depends on parameters, else `Unknown`.

    A text is true if it is not empty.
    """
    if isinstance(value, Either):
        truths = {truth(item) for item in value.items if not isinstance(item, Object)}
        if len(truths) == 1 == len(value.items):
            return next(iter(truths))
        guards = [one for one in truths if isinstance(one, Guard)]
        other = next((one for one in truths if isinstance(one, Truth)), None)
        if other is not None and len(guards) == 1 and truths == {other, guards[0]}:
            terms = (opposite_terms if other.value else terms_of)(guards[0])
            return _guard(terms, whole=False, opposite=other.value)
        return Unknown("it depends")
    if isinstance(value, Truth):
        return value if value.parameter is None else Guard((value.parameter,))
    if isinstance(value, Guard):
        return value
    if isinstance(value, Unknown):
        if value.parameter is not None and _is_whole(value, value.parameter):
            return Guard((value.parameter,))
        return Truth(False) if value.reason == NULL.reason else value
    if isinstance(value, Number):
        return Truth(value.value != 0) if value.parameter is None else Unknown("it depends")
    if isinstance(value, Object):
        # A subscriber without a topic, for one, is an object and false.
        return Truth(True) if value.created and "empty" not in value.native else Unknown("it may be null")
    if isinstance(value, Text) and value.exact is not None and not value.unsure:
        return Truth(value.exact != "") if value.parameter is None else Guard((value.parameter,))
    if isinstance(value, (Sequence, Mapping)) and not value.open:
        return Truth(bool(value.items)) if value.parameter is None else Unknown("it depends")
    if isinstance(value, (Closure, Bound, TypeValue)):
        return Truth(True)
    return Unknown("it depends on a value")


def negate(condition: Truth | Guard | Unknown) -> Value:
    """Return the opposite of a condition."""
    if isinstance(condition, Truth):
        return Truth(not condition.value)
    if isinstance(condition, Guard) and condition.any_of:
        return _guard(opposite_terms(condition), whole=condition.whole)
    return _guard(terms_of(condition), whole=isinstance(condition, Guard) and condition.whole, opposite=True)


def terms_of(condition: Value) -> tuple[str, ...]:
    """Return the terms that hold if a condition does; none if no conjunction of parameters says so."""
    return condition.terms if isinstance(condition, Guard) and not condition.any_of else ()


def opposite_terms(condition: Value) -> tuple[str, ...]:
    """Return the terms that hold if a condition does not; none if no conjunction of parameters says so."""
    if isinstance(condition, Guard) and (condition.any_of or (condition.whole and len(condition.terms) == 1)):
        return tuple(map(negated_term, condition.terms))
    return ()


def negated_term(term: str) -> str:
    """Return the opposite of a term of a guard: `!use_imu` of `use_imu`."""
    if count := COUNT.fullmatch(term):
        return f"argc{_NEGATED[count[1]]}{count[2]}"
    return term[1:] if term.startswith("!") else f"!{term}"


def negative(value: Value) -> Value:
    """Return a number with the opposite sign."""
    if not isinstance(value, Number):
        return Unknown("it is computed")
    written = value.written[1:] if value.written.startswith("-") else f"-{value.written}"
    return Number(-value.value, written, value.parameter)
