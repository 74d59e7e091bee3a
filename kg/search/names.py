"""Known names for a search (types, licences, labels, all words), and options as strict filters that use these names."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING, Final

from kg.errors import UsageError
from kg.search.needs import Wish
from kg.search.options import FILTERS
from kg.search.words import content_terms, lexicon, phrase
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from kg.search.reading import Concept


ROLES: Final = ("subscribes", "publishes", "services", "clients", "action_servers", "action_clients")


_PIECE: Final = 2
_LEAST_LETTERS: Final = 4  # A shorter word is like too many others
_ALIKE: Final = 0.75  # words of which so many pieces of two letters are the same are spellings of one
_ENDING: Final = 2  # A word with so many letters more at its end may be a newer version of the other: yolox
_FEW: Final = 4


class Names:
    """Names of the features of an index, the words of its nodes, and their synonyms.

    `terms` are those that describe nodes. `synonyms` maps each phrase, as stems, to other phrases for the same thing:
    those of the lexicon and the labels of each concept.
    """

    def __init__(self, features: Iterable[str], concepts: Sequence[Concept], terms: Collection[str]) -> None:
        self._types: defaultdict[str, defaultdict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
        self._licenses: dict[str, str] = {}
        self.features = frozenset(features)
        for feature in sorted(self.features):
            kind, _, name = feature.partition(":")
            if kind in ROLES and name:
                self._types[kind][name].append(feature)
                self._types[kind][name.rpartition("/")[2]].append(feature)
            elif kind == "license":
                self._licenses[name.lower()] = feature
        self.concepts: Mapping[tuple[str, ...], tuple[str, ...]] = self._concepts(concepts)
        self.synonyms = _synonyms(concepts)
        self._terms = terms
        self._pieces: dict[str, list[str]] = {}
        self._spellings: dict[str, tuple[tuple[str, float], ...]] = {}

    def types(self, kind: str, name: str) -> tuple[str, ...]:
        """Return the features of a type: `LaserScan`, `sensor_msgs/LaserScan` or `sensor_msgs/msg/LaserScan`."""
        package, _, last = name.rpartition("/")
        package = package.partition("/")[0]
        return tuple(self._types[kind].get(f"{package}/{last}" if package else last, ()))

    def licenses(self, name: str) -> tuple[str, ...]:
        """Return the licences whose name begins with `name`, ignoring case: BSD is any of the BSD licences."""
        start = name.lower()
        return tuple(feature for name_of_licence, feature in self._licenses.items() if _begins(name_of_licence, start))

    def describes_node(self, term: str) -> bool:
        """Return whether a term describes a node."""
        return term in self._terms

    def spellings(self, term: str) -> tuple[tuple[str, float], ...]:
        """Return terms of nodes spelled like a term that describes no node, with their similarity, best first."""
        if term not in self._spellings:
            similar_terms = self._alike(term) if len(term) >= _LEAST_LETTERS else ()
            self._spellings[term] = tuple(sorted(similar_terms, key=lambda one: (-one[1], one[0]))[:_FEW])
        return self._spellings[term]

    def _alike(self, term: str) -> Iterator[tuple[str, float]]:
        if not self._pieces:
            pieces: defaultdict[str, list[str]] = defaultdict(list)
            for one in self._terms:
                for piece in _cut(one) if len(one) >= _LEAST_LETTERS else ():
                    pieces[piece].append(one)
            self._pieces = dict(pieces)
        own = _cut(term)
        shared = Counter(one for piece in own for one in self._pieces.get(piece, ()))
        for one, count in shared.items():
            likeness = 2 * count / (len(own) + len(_cut(one)))
            if one.startswith(term) and len(one) - len(term) <= _ENDING:
                likeness = max(likeness, _ALIKE)
            if likeness >= _ALIKE:
                yield one, likeness

    def _concepts(self, concepts: Sequence[Concept]) -> dict[tuple[str, ...], tuple[str, ...]]:
        by_stems: defaultdict[tuple[str, ...], list[str]] = defaultdict(list)
        for concept in concepts:
            feature = f"{concept.kind}:{concept.label}"
            if feature in self.features:
                for label in (concept.label, *concept.others):
                    by_stems[phrase(label)].append(feature)
        return {stems: tuple(dict.fromkeys(features)) for stems, features in by_stems.items() if stems}


def _cut(term: str) -> frozenset[str]:
    """Return the bigrams of a term, with marks at its ends."""
    marked = f"^{term}$"
    return frozenset(marked[at : at + _PIECE] for at in range(len(marked) - _PIECE + 1))


def _synonyms(concepts: Sequence[Concept]) -> Mapping[tuple[str, ...], tuple[tuple[str, ...], ...]]:
    groups = [*lexicon().synonyms, *((concept.label, *concept.others) for concept in concepts)]
    by_phrase: dict[tuple[str, ...], dict[tuple[str, ...], None]] = {}
    for group in groups:
        stems = [phrase(one) for one in group]
        others = [content_terms(one) for one in group if not one.startswith("=") and "not" not in one.split()]
        for one in filter(None, stems):
            by_phrase.setdefault(one, {}).update(dict.fromkeys(filter(None, others)))
    return {one: tuple(others) for one, others in by_phrase.items()}


def _begins(name: str, start: str) -> bool:
    return name.startswith(start) and not name[len(start) : len(start) + 1].isalpha()


_MOST: Final = 8  # so many values are named in an error; they fit a line
_NONE: Final = "No node has any; `kg nodes` lists the nodes."


def wishes(filters: Mapping[str, Sequence[str]], names: Names) -> tuple[Wish, ...]:
    """Return filters, values by kind, as wishes.

    Raises UsageError: KG701 for a type of messages or services that no node has in that role, KG702 for hardware, a
    function or a capability, KG703 for a licence, a package, a kind or a version of ROS.
    """
    return tuple(_wish(kind, value, names) for kind, values in filters.items() for value in values)


def filter_values(kind: str, names: Names) -> list[str]:
    """Return the possible values of a filter, sorted."""
    kinds = FILTERS[kind].roles or (kind,)
    return sorted({name.partition(":")[2] for name in names.features if name.partition(":")[0] in kinds})


def _wish(kind: str, value: str, names: Names) -> Wish:
    features = _features(kind, value.strip(), names)
    if not features:
        choices = filter_values(kind, names)
        near = did_you_mean(value, [*choices, *(name.rpartition("/")[2] for name in choices if FILTERS[kind].roles)])
        named = ", ".join(f"`{one}`" for one in choices[:_MOST])
        some = f"There are {named}{' and more' if len(choices) > _MOST else ''}." if choices else _NONE
        raise UsageError(FILTERS[kind].code, f"no node of the store has `--{kind} {value}`", hint=near or some)
    return Wish(kind, features, value, strict=True)


def _features(kind: str, value: str, names: Names) -> tuple[str, ...]:
    if roles := FILTERS[kind].roles:
        return tuple(feature for role in roles for feature in names.types(role, value))
    if kind == "license":
        return names.licenses(value)
    if kind in {"hardware", "function", "capability"}:
        features = names.concepts.get(phrase(value), ())
        return tuple(feature for feature in features if feature.startswith(f"{kind}:"))
    feature = f"{kind}:{value}"
    return (feature,) if feature in names.features else ()
