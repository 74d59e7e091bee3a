"""What a definition that a peer tells may ask for: no type within itself, no value that is large while empty."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from rosbags.interfaces import Nodetype

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rosbags.typesys.store import Typestore

    from kg.robot.messages.definitions import Definition

__all__ = ["check_size"]

_MOST_PARTS: Final = 4096
_DEEPEST: Final = 32
_NUMBERS_OF_A_PART: Final = 1024


def check_size(store: Typestore, new: Mapping[str, Definition], known: Callable[[str], str]) -> None:
    """Raise ValueError for definitions whose values nobody could keep; `known` gives the names of the store.

    Lists of messages without fields are refused too: four bytes could ask for billions of them.
    """
    _Measure(store, new, known).all()


class _Measure:
    def __init__(self, store: Typestore, new: Mapping[str, Definition], known: Callable[[str], str]) -> None:
        self._store = store
        self._new = new
        self._known = known
        self._parts: dict[str, int] = {}

    def all(self) -> None:
        for name in self._new:
            self._of_message(name, ())

    def _of_message(self, name: str, within: tuple[str, ...]) -> int:
        """Return how many values a message has at least; those of an array of numbers count together."""
        if name in within or len(within) > _DEEPEST:
            raise ValueError(f"`{name}` contains itself" if name in within else "its messages are nested too deeply")
        if name not in self._parts:
            found = sum(self._of(kind, (*within, name)) for kind in self._kinds(name))
            if found > _MOST_PARTS:
                raise ValueError(f"a `{name}` has more than {_MOST_PARTS} values")
            self._parts[name] = found
        return self._parts[name]

    def _kinds(self, name: str) -> list[Any]:
        if name in self._new:
            return [field.kind for field in self._new[name].fields]
        return [kind for _, kind in self._store.fielddefs[self._known(name)][1]]

    def _of(self, kind: Any, within: tuple[str, ...]) -> int:
        sort, inner = kind
        if sort is Nodetype.BASE:
            return 1
        if sort is Nodetype.NAME:
            return self._of_message(inner.replace("/msg/", "/"), within)
        element, length = inner
        each = self._of(element, within)
        if sort is Nodetype.SEQUENCE:
            if not each:
                raise ValueError(f"a list of `{element[1]}` has elements without content")
            return 1
        numbers = element[0] is Nodetype.BASE and element[1][0] != "string"
        return 1 + length // _NUMBERS_OF_A_PART if numbers else int(length * each)
