"""Chains of places as one text: includes of launch files, and calls of code."""

from __future__ import annotations

from kg.facts import Location


def chain_text(chain: tuple[Location, ...]) -> str | None:
    """Return a chain as one text, None if it is empty; a place in another source has its repository in front."""
    return " > ".join(f"{one.repository}//{one}" if one.repository else str(one) for one in chain) or None


def chain_of(text: str | None) -> tuple[Location, ...]:
    """Return the places of a text that `chain_text` wrote."""
    return tuple(map(_place, text.split(" > "))) if text else ()


def _place(text: str) -> Location:
    place, _, line = text.rpartition(":")
    repository, mark, path = place.partition("//")
    return Location(path if mark else place, int(line), repository if mark else None)


def likely_chain(path: str, chain: tuple[Location, ...]) -> tuple[Location, ...]:
    """Return the includes that most likely led to a line of `path`, which concerns a node with the includes `chain`.

    A file that is itself among the includes is reached by those before it.
    """
    at = next((index for index, one in enumerate(chain) if one.path == path), len(chain))
    return chain[:at]
