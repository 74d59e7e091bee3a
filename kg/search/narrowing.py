"""Which question narrows hits best: the property whose values split them most evenly.

Each value that a question offers is one of a filter (`kg.search.filters`), so an answer is a filter more.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.search.searching import Hit

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
