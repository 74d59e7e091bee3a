"""Notes of a search about words: their interpretation, and suggestions if nothing was found."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.similar import did_you_mean

if TYPE_CHECKING:
    from kg.search.needs import Need, Wish
    from kg.search.searching import Search

NEAREST: Final = "nothing here fits; nearest are"

_VERBS: Final = {"services": "offers", "clients": "calls"}
"""Verbs for kinds of wishes whose name is not one."""
_LABELLED: Final = {"hardware", "function", "capability"}
_LONGEST_NAME: Final = 80


def understood(need: Need) -> tuple[list[str], list[str]]:
    """Return the interpretation of the words: required wishes, and preferred ones."""
    strict = dict.fromkeys(_wish_words(wish) for wish in need.wishes if wish.strict)
    rather = dict.fromkeys(_wish_words(wish) for wish in need.wishes if not wish.strict)
    return list(strict), list(rather)


def unknown(need: Need) -> list[str]:
    """Return sentences about the words that describe no node, with and without similar spellings."""
    strange = [one for one in need.wordings if one.unknown]
    sentences = []
    for start, words in (
        ("no description of a node mentions", [one.text for one in strange if not one.near]),
        ("searched for near spellings of", [one.text for one in strange if one.near]),
    ):
        if words:
            sentences.append(f"{start} {', '.join(f'`{word}`' for word in words)}")
    return sentences


def near(words: str, search: Search) -> str | None:
    """Return a "did you mean" question with names similar to a single word; None if there are none."""
    if len(words.split()) != 1 or len(words) > _LONGEST_NAME:
        return None
    return did_you_mean(words, sorted({search.index.nodes[place].name for place in range(search.index.size)}))


def _wish_words(wish: Wish) -> str:
    """Return a wish in words: types as typed, hardware and other concepts by their labels."""
    label = wish.features[0].partition(":")[2]
    if wish.kind == "ros":
        return f"ROS {label}"
    return f"{_VERBS.get(wish.kind, wish.kind)} {label if wish.kind in _LABELLED else wish.wording}"
