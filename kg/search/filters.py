"""Options as strict filters; an unknown name is an error with suggestions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.errors import UsageError
from kg.search.needs import Wish
from kg.search.options import FILTERS
from kg.search.words import phrase
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.search.names import Names

_TYPED: Final = {
    "subscribes": ("subscribes",),
    "publishes": ("publishes",),
    "services": ("services", "action_servers"),
    "calls": ("clients", "action_clients"),
}
_MOST: Final = 8  # so many values are named in an error; they fit a line
_NONE: Final = "No node has any; `kg nodes` lists the nodes."


def wishes(filters: Mapping[str, Sequence[str]], names: Names) -> tuple[Wish, ...]:
    """Return filters, values by kind, as wishes.

    Raises:
        UsageError: KG701 for a type of messages or services that no node has in that role, KG702 for hardware, a
            function or a capability, KG703 for a licence, a package, a kind or a version of ROS.
    """
    return tuple(_wish(kind, value, names) for kind, values in filters.items() for value in values)


def filter_values(kind: str, names: Names) -> list[str]:
    """Return the possible values of a filter, sorted."""
    kinds = _TYPED.get(kind, (kind,))
    return sorted({name.partition(":")[2] for name in names.features if name.partition(":")[0] in kinds})


def _wish(kind: str, value: str, names: Names) -> Wish:
    features = _features(kind, value.strip(), names)
    if not features:
        choices = filter_values(kind, names)
        near = did_you_mean(value, [*choices, *(name.rpartition("/")[2] for name in choices if kind in _TYPED)])
        named = ", ".join(f"`{one}`" for one in choices[:_MOST])
        some = f"There are {named}{' and more' if len(choices) > _MOST else ''}." if choices else _NONE
        raise UsageError(FILTERS[kind].code, f"no node of the store has `--{kind} {value}`", hint=near or some)
    return Wish(kind, features, value, strict=True)


def _features(kind: str, value: str, names: Names) -> tuple[str, ...]:
    if kind in _TYPED:
        return tuple(feature for role in _TYPED[kind] for feature in names.types(role, value))
    if kind == "license":
        return names.licenses(value)
    if kind in {"hardware", "function", "capability"}:
        features = names.concepts.get(phrase(value), ())
        return tuple(feature for feature in features if feature.startswith(f"{kind}:"))
    feature = f"{kind}:{value}"
    return (feature,) if feature in names.features else ()
