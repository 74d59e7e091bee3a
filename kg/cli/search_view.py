"""Hits of a search as rows, and what was understood of the words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.cli.diagnostics import note

if TYPE_CHECKING:
    from kg.search.needs import Need
    from kg.search.searching import Hit

__all__ = ["row", "understood"]

_REASONS = 3


def row(hit: Hit) -> tuple[object, ...]:
    """Return the cells of a hit: rank, score, package, node, why, also in, file:line."""
    why = "; ".join(str(reason) for reason in hit.why[:_REASONS])
    also = ", ".join(
        dict.fromkeys(
            one.name if package.iri == hit.package.iri else f"{package.repository}:{package.name}/{one.name}"
            for package, one in hit.others
        )
    )
    return hit.rank, f"{hit.score:.2f}", hit.package.name, hit.name, why, also, f"{hit.node.path}:{hit.node.line}"


def understood(need: Need) -> None:
    """Tell on standard error which filters and preferences the words were taken for."""
    strict = [f"{wish.kind} {wish.said}" for wish in need.wishes if wish.strict]
    rather = [f"{wish.kind} {wish.said}" for wish in need.wishes if not wish.strict]
    if strict:
        note(f"only what {', '.join(dict.fromkeys(strict))}")
    if rather:
        note(f"rather what {', '.join(dict.fromkeys(rather))}")
