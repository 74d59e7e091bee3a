"""Interfaces that frameworks add to a node by themselves, by the table `ontology/implicit.toml`.

The table's head explains its form. The facts made here are marked `implicit`, are at the line of code that brought
the framework in, and name the mark (and the condition, if there is one) as their `origin`.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any, Final

from kg.errors import Place, UsageError
from kg.extract.marks import Extracted, Mark
from kg.facts import Access, Interface, Location, NodeType, Parameter, Qos, Resolution, Role
from kg.holes import is_partial
from kg.names import normalise
from kg.resources import folder

if TYPE_CHECKING:
    from pathlib import Path


_TABLE_FILE: Final = "implicit.toml"
_PROBE: Final = Mark("probe", Location("", 1), "namespace", "detail")
"""Fills every placeholder, so that each row can be tried when the table is loaded."""


@dataclass(frozen=True, slots=True)
class Use:
    """One `[[use]]` of the table: what the nodes with a mark get, if version and language of ROS agree."""

    mark: str
    interfaces: tuple[dict[str, Any], ...]
    parameters: tuple[dict[str, Any], ...]
    ros: int | None = None
    language: str | None = None
    condition: str | None = None

    def applies(self, mark: Mark, node: NodeType) -> bool:
        """Return whether a node gets this for a mark."""
        return self.mark == mark.key and self.ros in (None, node.ros) and self.language in (None, node.language)

    @property
    def origin(self) -> str:
        """What the facts made from this name as their origin."""
        return f"{self.mark}, if {self.condition}" if self.condition else self.mark


def add(extracted: Extracted) -> NodeType:
    """Return the node with the implicit interfaces and parameters that its marks bring; each name once."""
    node = extracted.node
    plain = any(mark.key == "rcl.node" for mark in extracted.marks)  # of C, without what the classes of nodes add
    marks = extracted.marks if plain else (Mark(f"ros{node.ros}.node", node.location), *extracted.marks)
    interfaces = {(fact.role, fact.name): fact for fact in node.interfaces}
    parameters = {fact.name: fact for fact in node.parameters}
    for mark in marks:
        for use in _table():
            if use.applies(mark, node):
                for interface in _interfaces(use, mark):
                    interfaces.setdefault((interface.role, interface.name), interface)
                for parameter in _parameters(use, mark):
                    parameters.setdefault(parameter.name, parameter)
    own = set(node.interfaces)
    new = tuple(fact for fact in interfaces.values() if fact not in own)
    declared = set(node.parameters)
    settings = tuple(fact for fact in parameters.values() if fact not in declared)
    return replace(node, interfaces=node.interfaces + new, parameters=node.parameters + settings)


def _interfaces(use: Use, mark: Mark) -> list[Interface]:
    return [
        Interface(
            role=Role(row["role"]),
            name=name,
            type=row["type"],
            resolution=Resolution.PARTIAL if is_partial(name) else Resolution.LITERAL,
            location=mark.location,
            implicit=True,
            origin=use.origin,
            via=mark.via,
            qos=Qos(**row["qos"]) if "qos" in row else None,
            reason=_reason(mark) if is_partial(name) else None,
        )
        for row in use.interfaces
        if (name := _name(row["name"], mark)) is not None
    ]


def _reason(mark: Mark) -> str:
    """Return why a name that a mark makes is not known in full."""
    if is_partial(mark.namespace):
        return "the namespace that the code gives to it is not known"
    return "a part of it is made by its library when the program runs"


def _parameters(use: Use, mark: Mark) -> list[Parameter]:
    return [
        Parameter(
            name=name,
            type=row["type"],
            default=row.get("default"),
            access=Access(row["access"]),
            location=mark.location,
            implicit=True,
            origin=use.origin,
            via=mark.via,
        )
        for row in use.parameters
        if (name := _name(row["name"], mark)) is not None
    ]


def _name(pattern: str, mark: Mark) -> str | None:
    """Return the name that a mark makes of a pattern; None when the mark does not hold what the pattern needs."""
    if "{detail}" in pattern and not mark.detail:
        return None
    if not mark.namespace:
        pattern = pattern.removeprefix("{namespace}/")  # of the node's own namespace, which is not a root
    return normalise(pattern.replace("{namespace}", mark.namespace).replace("{detail}", mark.detail or ""))


@cache
def _table() -> tuple[Use, ...]:
    return load_table(folder("ontology") / _TABLE_FILE)


def load_table(path: Path) -> tuple[Use, ...]:
    """Return the rows of a table file; a `UsageError` KG002 names the problems of one that cannot be used."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
        uses = tuple(_use(row) for row in content["use"])
        for use in uses:
            _interfaces(use, _PROBE)
            _parameters(use, _PROBE)
    except (OSError, tomllib.TOMLDecodeError, KeyError, TypeError, ValueError) as error:
        message = f"the table of implicit interfaces cannot be used: {type(error).__name__}: {error}"
        raise UsageError("KG002", message, place=Place(str(path))) from error
    return uses


def _use(row: dict[str, Any]) -> Use:
    return Use(
        row["mark"],
        tuple(row.get("interfaces", ())),
        tuple(row.get("parameters", ())),
        row.get("ros"),
        row.get("language"),
        row.get("condition"),
    )
