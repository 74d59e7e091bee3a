"""What an evaluation has chosen so far, and where values come in from: call sites and construction sites.

An expression can have several values. Each comes with the `Context` of choices that led to it, so that the
arguments of one interface call, evaluated one after the other in the contexts of those before, agree on
which call of a helper, which object and which turn of a loop they speak about.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Hashable

    from kg.extract.cpp.unit import Expr

__all__ = ["EMPTY", "Context", "Site"]


class Context:
    """An immutable mapping of choice points to choices."""

    __slots__ = ("_choices", "depth")

    def __init__(self, choices: dict[Hashable, object] | None = None, depth: int = 0) -> None:
        self._choices = choices or {}
        self.depth = depth

    def get(self, key: Hashable) -> object | None:
        """Return what was chosen at `key`, None where nothing was yet."""
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


EMPTY: Final = Context()


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """A call of a function or a construction of an object.

    `arguments` stand where they are written; `template` are explicit template arguments. `context` is set
    where the arguments belong to an evaluation that went forward into a function, None where they are to be
    seen in the context that reached the site.
    """

    where: Expr
    arguments: tuple[Expr, ...]
    template: tuple[Expr, ...] = ()
    context: Context | None = field(default=None, compare=False)
