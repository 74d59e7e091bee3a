"""Reasons of a hit: the parts of its score in words, each with the line that shows it."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.graph.texts import SENTENCE_END
from kg.holes import anonymous
from kg.search.fields import own_words
from kg.search.lexicon import lexicon
from kg.search.ranking import gain, share
from kg.search.words import terms

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from kg.search.documents import Document, PackageDocument, Text
    from kg.search.index import Index
    from kg.search.needs import Need, Wish

_VERBS: Final = {
    "publishes": "publishes",
    "subscribes": "subscribes",
    "services": "provides the service",
    "clients": "calls the service",
    "action_servers": "provides the action",
    "action_clients": "calls the action",
}
_ROLES: Final = {
    "services": ("services", "action_servers"),
    "calls": ("clients", "action_clients"),
}
_KINDS: Final = {
    "comment": "a comment says",
    "docstring": "its docstring says",
    "manifest": "its package says",
    "readme": "a page says",
    "usage": "a page says",
    "launch": "a launch file says",
    "wiki": "its documentation says",
    "plugin": "its description says",
}
_CLASSES: Final = {"hardware": "works with {}", "function": "is for {}", "capability": "can {}"}
_EXCERPT: Final = 90  # maximum number of characters of a text in a reason
_MORE: Final = " …"


@dataclass(frozen=True, slots=True)
class Reason:
    """A part of a node's score in words; `path` and `line` are relative to its repository, None without a line."""

    text: str
    weight: float
    path: str | None = None
    line: int | None = None

    def __str__(self) -> str:
        return self.text if self.path is None else f"{self.text} at {self.path}:{self.line}"


def reasons(index: Index, need: Need, place: int, limit: int) -> tuple[Reason, ...]:
    """Return up to `limit` reasons for the score of the node at an index, the most important first."""
    node = index.nodes[place]
    package = index.packages[node.package]
    weights = _weights(index, need, place)
    candidates = [*_of_wishes(index, need.wishes, weights, node, package), *_of_words(weights, node, package)]
    candidates.sort(key=lambda one: (-one.weight, one.text))
    seen: dict[str, Reason] = {}
    for one in candidates:
        # `named scan` and `named scan.py` are the same reason.
        seen.setdefault("named" if one.text.startswith("named ") else one.text, one)
    return tuple(seen.values())[:limit]


def _weights(index: Index, need: Need, place: int) -> dict[str, float]:
    """Return the score of each term of the need for a node."""
    weights: dict[str, float] = {}
    for wording in need.wordings:
        part = share(index, need, wording)
        for one in wording.alternatives:
            for term in one.terms:
                value = part * one.weight * index.text.value(term, place)
                weights[term] = max(value, weights.get(term, 0.0))
    return {term: value for term, value in weights.items() if value > 0}


def _of_wishes(
    index: Index, wishes: Iterable[Wish], weights: Mapping[str, float], node: Document, package: PackageDocument
) -> Iterator[Reason]:
    for wish in wishes:
        features = set(wish.features)
        weight = gain(index, wish) + (1.0 if wish.strict else 0.0)
        for end in node.ends:
            if end.role in _ROLES.get(wish.kind, (wish.kind,)) and f"{end.role}:{end.type}" in features:
                words = terms(f"{anonymous(end.name or '')} {(end.type or '').rpartition('/')[2]}")
                words_weight = sum(weights.get(term, 0.0) for term in set(words))
                yield Reason(f"{_VERBS[end.role]} {end.type}", weight + words_weight / 2, end.path, end.line)
                break
        labels = {"hardware": node.hardware, "function": node.functions, "capability": node.capabilities}
        if wish.kind in labels:
            matching = [label for label in labels[wish.kind] if f"{wish.kind}:{label}" in features]
            matching = matching or ([wish.features[0].partition(":")[2]] if wish.strict else [])
            yield from (Reason(_CLASSES[wish.kind].format(label), weight) for label in matching[:1])
        if wish.strict and wish.kind == "license":
            yield Reason(f"licence {' and '.join(package.licenses)}", 0.5, package.path, 1)


def _of_words(weights: Mapping[str, float], node: Document, package: PackageDocument) -> Iterator[Reason]:
    """Yield a reason for each place that contains words of the need, with its score."""
    fields = lexicon().weights["fields"]

    def worth(text: str, field: str) -> float:
        return sum(weights.get(term, 0.0) for term in set(terms(text))) * min(1.0, fields[field])

    for field, text in own_words(node):
        if field in {"name", "plugin"} and (value := worth(text, field)):
            yield Reason(f"named {text}", value, node.path, node.line)
    yield from _best(node.texts, lambda text, _: worth(text, "text"))
    others = [text for text in package.texts if text.kind != "manifest"]
    yield from _best(others, lambda text, kind: worth(text, "usage" if kind == "usage" else "readme"))
    if value := worth(package.name, "package"):
        yield Reason(f"in the package {package.name}", value, package.path, 1)
    if package.description and (value := worth(package.description, "manifest")):
        excerpt = _excerpt(package.description, lambda one: worth(one, "manifest"))
        yield Reason(f"its package says “{excerpt}”", value, package.path, 1)
    for end in node.ends:
        if value := worth(f"{anonymous(end.name or '')} {(end.type or '').rpartition('/')[2]}", "interface"):
            yield Reason(f"{_VERBS[end.role]} {end.name or end.type}", value * 0.5, end.path, end.line)
    for name, description in node.parameters:
        if value := worth(f"{name} {description or ''}", "parameter"):
            yield Reason(f"has the parameter {name}", value * 0.5)


def _best(texts: Iterable[Text], worth: Callable[[str, str], float]) -> Iterator[Reason]:
    valued = [(worth(text.text, text.kind), text) for text in texts]
    value, best = max(valued, key=lambda one: one[0], default=(0.0, None))
    if best is not None and value > 0:
        excerpt = _excerpt(best.text, lambda text: worth(text, best.kind))
        yield Reason(f"{_KINDS.get(best.kind, 'it says')} “{excerpt}”", value, best.path, best.line)


def _excerpt(text: str, worth: Callable[[str], float]) -> str:
    """Return the beginning of the sentence whose beginning is worth the most, the first of equals."""
    text = " ".join(text.split())
    begins = [0, *(match.end() for match in SENTENCE_END.finditer(text))]
    shown = {at: textwrap.shorten(text[at:], _EXCERPT + len(_MORE), placeholder=_MORE) for at in begins}
    best = max(begins, key=lambda at: worth(shown[at]))
    return f"… {shown[best]}" if best else shown[best]
