"""Values that views compute once for a snapshot: its content never changes while it is held."""

from __future__ import annotations

from functools import wraps
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.store.snapshot import EmbeddedSnapshot

_Rest = ParamSpec("_Rest")
_Found = TypeVar("_Found")
_KNOWN: WeakKeyDictionary[Any, dict[Any, Any]] = WeakKeyDictionary()


def once(
    function: Callable[Concatenate[EmbeddedSnapshot, _Rest], _Found],
) -> Callable[Concatenate[EmbeddedSnapshot, _Rest], _Found]:
    """Cache `function`: it runs once for a snapshot and other arguments, which are hashable.

    The result is shared and must not be changed; it is released with the snapshot.
    """
    return _cached(function, several=True)


def while_last(
    function: Callable[Concatenate[EmbeddedSnapshot, _Rest], _Found],
) -> Callable[Concatenate[EmbeddedSnapshot, _Rest], _Found]:
    """Cache the last result of `function`: it runs again only for other arguments, as `once`; for large results."""
    return _cached(function, several=False)


def _cached(
    function: Callable[Concatenate[EmbeddedSnapshot, _Rest], _Found], *, several: bool
) -> Callable[Concatenate[EmbeddedSnapshot, _Rest], _Found]:
    """Return `function` with its answers to several arguments kept, or with the last alone."""

    @wraps(function)
    def cached(snapshot: EmbeddedSnapshot, /, *arguments: _Rest.args, **named: _Rest.kwargs) -> _Found:
        answers: dict[Any, _Found] = _KNOWN.setdefault(snapshot, {}).setdefault(function, {})
        key = (arguments, tuple(sorted(named.items())))
        if key not in answers:
            value = function(snapshot, *arguments, **named)
            if not several:
                answers.clear()
            answers[key] = value
        return answers[key]

    return cached
