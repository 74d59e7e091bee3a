"""Short descriptions of interfaces, parameters and plugin slots, the same in every interface."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from kg.facts import Access, Interface, Parameter, PluginSlot, Qos, Resolution
from kg.render.conditions import condition

LANGUAGES: Final = {"cpp": "C++", "python": "Python"}
_DONE: Final = {Access.DECLARE: "declared", Access.READ: "read", Access.WRITE: "written"}


def how(fact: Interface) -> str:
    """Return when an interface is created, how its name became known, the quality of service, and how it is used."""
    unknown = fact.resolution in {Resolution.PARTIAL, Resolution.UNRESOLVED}
    reason = (fact.reason or fact.written or "").removeprefix("it is ") if unknown else ""
    words = [condition(fact.switches)]
    if fact.parameter and fact.parameter not in reason:
        words.append(f"parameter {fact.parameter}")
    elif not fact.parameter and fact.resolution not in {Resolution.LITERAL, Resolution.CONSTANT}:
        reason = f"{fact.resolution}: {reason}" if reason else str(fact.resolution)
    words.append(reason)
    if fact.origin:
        words.append(f"from {fact.origin}")
    words.append(str(fact.qos or ""))
    words.append("never published" if fact.silent else "ignored" if fact.ignored else "")
    words.append(f"without {' and '.join(fact.unset)}" if fact.unset else "")
    return ", ".join(word for word in words if word)


def quality(switches: Iterable[str], qos: Qos | None, doubt: str | None = None) -> str:
    """Return the conditions under which an end exists and has its name, and its quality of service."""
    return ", ".join(filter(None, (condition(switches), doubt, str(qos or ""))))


def how_loaded(fact: PluginSlot) -> str:
    """Return the origin of the class of the plugins of a slot, and their names."""
    if fact.fixed:
        return "fixed in the code"
    if fact.parameter is None:
        return f"not known: {fact.reason}" if fact.reason else "not known"
    listed = fact.names is not None and not fact.parameter.startswith(f"{fact.names}[]")
    return f"parameters {fact.names}, {fact.parameter}" if listed else f"parameter {fact.parameter}"


def parameter_groups(facts: Iterable[Parameter]) -> list[list[Parameter]]:
    """Return the facts about each parameter together, sorted by name: code may read and write one at many places.

    The first of a group is where it is declared, or read. Those that frameworks make come last.
    """
    named: dict[Any, list[Parameter]] = {}
    for fact in facts:
        named.setdefault(fact.name if fact.name is not None else fact.location, []).append(fact)
    order = [Access.DECLARE, Access.READ, Access.WRITE]
    groups = [sorted(group, key=lambda one: (order.index(one.access), str(one.location))) for group in named.values()]
    return sorted(
        groups, key=lambda group: (all(one.implicit for one in group), group[0].name is None, group[0].name or "")
    )


def accesses(facts: Sequence[Parameter]) -> str:
    """Return the accesses of code to a parameter, unless it only declares it once."""
    if len(facts) == 1 and facts[0].access is Access.DECLARE:
        return ""
    done = ", ".join(dict.fromkeys(_DONE[fact.access] for fact in facts))
    return f"{done} ({len(facts)} places)" if len(facts) > 1 else done


def quoted(code: Mapping[str, Any]) -> str:
    """Return a line of code, as `kg.views.evidence.Places.code` gives it, and whether it is from the store."""
    text = (code["line_text"] or "").strip()
    return f"{text}  (stored)" if text and code["line_stored"] else text
