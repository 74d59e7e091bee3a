"""What an evaluation has chosen so far, and where values come in from: call sites and construction sites.

An expression can have several values. Each comes with the `Context` of choices that led to it, so that the
arguments of one interface call, evaluated one after the other in the contexts of those before, agree on
which call of a helper, which object and which turn of a loop they speak about.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

    from kg.extract.cpp.unit import Expr
    from kg.extract.values import Value

__all__ = ["EMPTY", "Context", "Memory", "Site"]

# What the evaluations that are under way have looked at, innermost last; contexts report to it, and since they
# are made everywhere, it is the one thing here that stands for the whole process.
_looked: list[set[Hashable]] = []


class Context:
    """An immutable mapping of choice points to choices."""

    __slots__ = ("_choices", "depth")

    def __init__(self, choices: dict[Hashable, object] | None = None, depth: int = 0) -> None:
        self._choices = choices or {}
        self.depth = depth

    def get(self, key: Hashable) -> object | None:
        """Return what was chosen at `key`, None where nothing was yet."""
        if _looked:
            _looked[-1].add(key)
        return self._choices.get(key)

    def bind(self, key: Hashable, choice: object) -> Context:
        """Return the context with one choice more."""
        return Context({**self._choices, key: choice}, self.depth)

    def deeper(self) -> Context:
        """Return the same choices one step further down."""
        return Context(self._choices, self.depth + 1)

    def at(self, depth: int) -> Context:
        """Return the same choices at a given depth."""
        return self if depth == self.depth else Context(self._choices, depth)

    def after(self, other: Context) -> dict[Hashable, object]:
        """Return the choices that `other` has and this context has not."""
        own = self._choices
        if other._choices is own:
            return {}
        return {key: choice for key, choice in other._choices.items() if own.get(key) is not choice}

    def with_all(self, choices: dict[Hashable, object]) -> Context:
        """Return the context with more choices."""
        return Context({**self._choices, **choices}, self.depth) if choices else self


EMPTY: Final = Context()

_Found = list[tuple["Value", Context]]


class Memory:
    """Results of evaluations, each with the choices that it looked at.

    A result holds in every context that has the same choices there, whatever else was chosen; what it chose
    itself is added again.
    """

    def __init__(self) -> None:
        self._known: dict[
            Hashable, list[tuple[dict[Hashable, object], list[tuple[Value, dict[Hashable, object]]]]]
        ] = {}

    def recall(self, key: Hashable, context: Context, evaluate: Callable[[], tuple[_Found, bool]]) -> _Found:
        """Return what is known of `key`, or what `evaluate` finds, kept unless it says that bounds cut it short."""
        for needed, kept in self._known.get(key, ()):
            choices = context._choices  # noqa: SLF001 - the memory is the context's other half
            if all(choices.get(point) is choice for point, choice in needed.items()):
                if _looked:
                    _looked[-1].update(needed)
                return [(value, context.with_all(more)) for value, more in kept]
        _looked.append(set())
        try:
            found, whole = evaluate()
        finally:
            looked = _looked.pop()
            if _looked:
                _looked[-1].update(looked)
        if whole:
            needed = {point: context._choices.get(point) for point in looked}  # noqa: SLF001 - as above
            kept = [(value, context.after(chosen)) for value, chosen in found]
            self._known.setdefault(key, []).append((needed, kept))
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """A call of a function or a construction of an object.

    `arguments` stand where they are written; `template` are explicit template arguments. `context` is set
    where the arguments belong to an evaluation that went forward into a function, None where they are to be
    seen in the context that reached the site. `place` is where the arguments of a member stand, when that is not
    where the member is declared: the entry in the initialiser list of a constructor.
    """

    where: Expr
    arguments: tuple[Expr, ...]
    template: tuple[Expr, ...] = ()
    context: Context | None = field(default=None, compare=False)
    place: Expr | None = field(default=None, compare=False)
