from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import given
from hypothesis import strategies as st

from kg.extract.cpp.context import EMPTY, Context, Memory
from kg.extract.values import Number

if TYPE_CHECKING:
    from kg.extract.values import Value

POINTS = st.sampled_from("abcd")
PLANS = st.lists(st.tuples(st.sampled_from(["look", "choose", "inner"]), POINTS), max_size=5)


def evaluated(
    plans: dict[str, list[tuple[str, str]]], name: str, context: Context, memory: Memory | None
) -> list[tuple[Value, Context]]:
    """Follow the plan of a name: look at choices, make them, or evaluate the name that comes after it."""

    def evaluate() -> tuple[list[tuple[Value, Context]], bool]:
        seen, current = 0, context
        for action, point in plans[name]:
            if action == "look":
                seen = seen * 3 + (1 if current.get(point) is None else 2)
            elif action == "choose" and current.get(point) is None:
                current = current.bind(point, True)
            elif action == "inner" and point > name:
                for value, after in evaluated(plans, point, current, memory):
                    seen, current = seen * 3 + int(value.value if isinstance(value, Number) else 0), after
        return [(Number(float(seen), str(seen)), current)], True

    return evaluate()[0] if memory is None else memory.recall(name, context, evaluate)


@given(
    plans=st.fixed_dictionaries(dict.fromkeys("abcd", PLANS)),
    order=st.lists(st.tuples(POINTS, st.sets(POINTS)), min_size=1, max_size=8),
)
def test_memory_changes_no_result(plans: dict[str, list[tuple[str, str]]], order: list[tuple[str, set[str]]]) -> None:
    """Whatever is evaluated in whatever contexts, from memory comes what evaluation would have given."""
    memory = Memory()
    for name, chosen in order:
        context = EMPTY
        for point in sorted(chosen):
            context = context.bind(point, True)
        fresh = evaluated(plans, name, context, None)
        known = evaluated(plans, name, context, memory)
        assert [value for value, _ in known] == [value for value, _ in fresh]
        for (_, one), (_, other) in zip(known, fresh, strict=True):
            assert all(one.get(point) is other.get(point) for point in "abcd")


def test_what_was_cut_short_is_not_kept() -> None:
    """A result that a bound cut short is found anew the next time."""
    memory, found = Memory(), iter((1, 2))

    def evaluate() -> tuple[list[tuple[Value, Context]], bool]:
        number = next(found)
        return [(Number(float(number), str(number)), EMPTY)], False

    assert [memory.recall("x", EMPTY, evaluate)[0][0] for _ in range(2)] == [Number(1.0, "1"), Number(2.0, "2")]
