"""A need and its answer in words: how it was read, what is unknown, and questions that split the hits."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.search.needs import Need, Wish
    from kg.search.searching import Hit, Search


NEAREST: Final = "nothing here fits; nearest are"

_ENDS: Final = {
    "publishes": "publisher of",
    "subscribes": "subscriber of",
    "services": "server of",
    "clients": "client of",
}
"""Nouns for kinds of wishes that are roles."""
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


def advice(need: Need, search: Search) -> str:
    """Return what to do after a search without results: use other words, a name similar to a single word, or less."""
    text = need.text.strip()
    if text and not need.wordings and not need.wishes:
        return f"`{text}` does not describe a node. Use words for what the node does."
    names = {search.index.nodes[place].name for place in range(search.index.size)}
    alone = len(text.split()) == 1 and len(text) <= _LONGEST_NAME
    return (did_you_mean(text, names) if alone else None) or "Try fewer words or filters."


def _wish_words(wish: Wish) -> str:
    """Return a wish in words: types as typed, hardware and other concepts by their labels."""
    label = wish.features[0].partition(":")[2]
    if wish.kind == "ros":
        return f"ROS {label}"
    return f"{_ENDS.get(wish.kind, wish.kind)} {label if wish.kind in _LABELLED else wish.wording}"


QUESTIONS: Final = {
    "ros": "Which version of ROS?",
    "subscribes": "What does it subscribe to?",
    "publishes": "What does it publish?",
    "hardware": "Which hardware?",
    "function": "What is it for?",
    "kind": "Which kind of node?",
    "license": "Which licence?",
    "package": "Which package?",
}
"""Questions by the filter of their answers; those that are easy for users come first."""
_MOST: Final = 6  # so many answers are offered, the most frequent ones
_OTHER: Final = frozenset(
    ("rosgraph_msgs/Log", "tf2_msgs/TFMessage", "tf/tfMessage", "diagnostic_msgs/DiagnosticArray")
)
"""Types that nodes have regardless of their function."""


@dataclass(frozen=True, slots=True)
class Question:
    """A question, and its answers with the number of remaining hits; an answer is a value of the filter `kind`."""

    kind: str
    text: str
    answers: tuple[tuple[str, int], ...]


def question(hits: Sequence[Hit], answered: Mapping[str, object]) -> Question | None:
    """Return the question that splits the hits best; None if no question other than those `answered` splits them."""
    best, most = None, 0.0
    for kind, text in QUESTIONS.items():
        counts = (
            Counter(value for hit in hits for value in set(_values(kind, hit))) if kind not in answered else Counter()
        )
        answers = [(value, count) for value, count in counts.most_common() if count < len(hits)][:_MOST]
        gained = max((_split(count / len(hits)) for _, count in answers), default=0.0)
        if gained > most:
            best, most = Question(kind, text, tuple(answers)), gained
    return best


def _split(share: float) -> float:
    """Return the information of a split into this share and the rest, in bits."""
    return -share * math.log2(share) - (1 - share) * math.log2(1 - share)


def _values(kind: str, hit: Hit) -> Iterator[str]:
    node, package = hit.node, hit.package
    if kind in {"subscribes", "publishes"}:
        yield from (end.type for end in node.ends if end.role == kind and end.type and end.type not in _OTHER)
    elif kind == "ros" and (node.ros or package.ros):
        yield str(node.ros or package.ros)
    elif kind == "kind":
        yield node.kind
    elif kind == "package":
        yield package.name
    yield from {"hardware": node.hardware, "function": node.functions, "license": package.licenses}.get(kind, ())
