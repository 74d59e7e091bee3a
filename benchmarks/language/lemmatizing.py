"""The tables of `kg.language.lemmas`, learned from a treebank."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING, Final

from kg.language.lemmas import LONGEST_ENDING, Table, lemma

if TYPE_CHECKING:
    from collections.abc import Iterable

    from treebank import Sentence

__all__ = ["learn"]

_INFLECTED: Final = ("NNS", "NNPS", "VBD", "VBG", "VBN", "VBP", "VBZ", "JJR", "JJS", "RBR", "RBS")
"""Tags of forms that differ from their lemma by an ending."""
_MOST_CUT: Final = 9
_ADDED: Final[Table] = {
    "NNS": {
        "axes": "axis",
        "calculi": "calculus",
        "caches": "cache",
        "chassis": "chassis",
        "dynamics": "dynamics",
        "electronics": "electronics",
        "headings": "heading",
        "indices": "index",
        "intrinsics": "intrinsics",
        "kinematics": "kinematics",
        "lenses": "lens",
        "matrices": "matrix",
        "optics": "optics",
        "physics": "physics",
        "poses": "pose",
        "robotics": "robotics",
        "vertices": "vertex",
    },
    "VBD": {"scaled": "scale", "timed": "time"},
    "VBN": {"scaled": "scale", "timed": "time"},
    "VBZ": {"does": "do", "goes": "go", "has": "have", "is": "be"},
}
"""Words of robotics whose ending misleads."""


def learn(sentences: Iterable[Sentence]) -> tuple[Table, Table]:
    """Return the exceptions and the endings that give the lemmas of the treebank, without what others imply.

    Each word counts once for an ending, however often it is written, as unknown words are rare ones.
    """
    seen: dict[tuple[str, str], Counter[str]] = defaultdict(Counter)
    for sentence in sentences:
        for word, tag, wanted in zip(sentence.words, sentence.tags, sentence.lemmas or (), strict=True):
            if wanted != "_":
                seen[tag, word.lower()][wanted] += 1
    wanted_of = {key: counts.most_common(1)[0][0] for key, counts in seen.items()}
    endings = _pruned(_endings(wanted_of))
    exceptions: Table = defaultdict(dict)
    for (tag, form), wanted in sorted(wanted_of.items()):
        if lemma(form, tag, {}, endings) != wanted:
            exceptions[tag][form] = wanted
    for tag, forms in _ADDED.items():
        exceptions[tag] = exceptions[tag] | forms
    return dict(exceptions), endings


def _endings(wanted_of: dict[tuple[str, str], str]) -> Table:
    votes: dict[tuple[str, str], Counter[str]] = defaultdict(Counter)
    for (tag, form), wanted in wanted_of.items():
        edit = _edit(form, wanted)
        if tag in _INFLECTED and int(edit[0]) < min(len(form), _MOST_CUT):
            for length in range(min(LONGEST_ENDING, len(form) - 1) + 1):
                votes[tag, form[len(form) - length :]][edit] += 1
    found: Table = defaultdict(dict)
    for (tag, ending), counts in votes.items():
        found[tag][ending] = min(counts.items(), key=lambda item: (-item[1], item[0]))[0]
    return dict(found)


def _pruned(endings: Table) -> Table:
    """Leave out the endings that do what the next shorter one does."""
    return {
        tag: {ending: edit for ending, edit in of_tag.items() if not ending or _shorter(of_tag, ending) != edit}
        for tag, of_tag in endings.items()
    }


def _shorter(of_tag: dict[str, str], ending: str) -> str | None:
    return next((of_tag[ending[cut:]] for cut in range(1, len(ending) + 1) if ending[cut:] in of_tag), None)


def _edit(form: str, wanted: str) -> str:
    same = 0
    while same < min(len(form), len(wanted)) and form[same] == wanted[same]:
        same += 1
    return f"{min(len(form) - same, 9)}{wanted[same:]}"
