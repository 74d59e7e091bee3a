"""Names that are likely meant to be one: typing errors, a namespace too many or too few, plurals, case, separators.

Deliberate differences are excluded: numbers (`camera1`, `camera2`), short words (`min_x`, `max_x`), and words that
differ in their first letter (`increase`, `decrease`). A misspelt name differs in one word only. Candidates are found by
keys that alike names share, so that a system of thousands of names costs in proportion to their number.

Two names are related if one has more to it: `imu/data` and `imu/data_compass`, `found/objects` and
`found/tracker/objects`. Names of the same words in another order are related too, if they end alike:
`camera/left/image`, `left_camera/image`. By itself this is weak evidence: many topics of a node are named so. Where
one end of each is missing, or the types agree and only one name has both ends, it is how a topic gets lost when a part
of a system is renamed.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import combinations
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.holes import is_known, is_partial
from kg.names import FRAMEWORK

if TYPE_CHECKING:
    from kg.facts import InstanceInterface, NodeInstance

Words: TypeAlias = "tuple[tuple[str, ...], ...]"
"""The words of each segment of a name, in small letters."""

_SEPARATORS: Final = re.compile(r"[_\-.]+|(?<=[a-z0-9])(?=[A-Z])")
_SHORT: Final = 4
"""Words with fewer letters are not taken for misspelt ones."""
_LONG: Final = 7
"""From this length on a word can have two errors."""
_COMMON: Final = 64
"""A form or an end that so many names share tells nothing about them."""
_MOST_WORDS: Final = 8
_MOST_EXTRA: Final = 2


def alike(one: str, other: str) -> bool:
    """Return whether two different names are likely meant to be the same; holds in both directions, never of itself."""
    if one == other or is_partial(one) or is_partial(other):
        return False
    if _form(one) == _form(other):
        return True
    longer, shorter = (one, other) if len(one) >= len(other) else (other, one)
    if longer[-1:] == shorter[-1:] and (_tail(longer, shorter) or _tail(shorter, longer)):
        return True
    return _misspelt(words_of(one), words_of(other))


def alike_when_short(one: str, other: str) -> bool:
    """Return whether a letter was put into a name, left out or swapped, in a word that is too short for `alike`.

    So many short words are one letter apart that this is weak evidence, unless one of the names is known to be wrong.
    """
    words, others = words_of(one), words_of(other)
    if is_partial(one) or is_partial(other) or len(words) != len(others):
        return False
    pairs = [(a, b) for a, b in zip(words, others, strict=True) if a != b]
    if len(pairs) != 1 or len(pairs[0][0]) != len(pairs[0][1]) or not one[-1:].isalpha():
        return False
    wrong = [(a, b) for a, b in zip(*pairs[0], strict=True) if a != b]
    if len(wrong) != 1 or max(sum(map(len, segment)) for segment in pairs[0]) < _SHORT:
        return False
    (a, b), whole = wrong[0], (wrong[0][0] + wrong[0][1]).isalpha()
    return whole and a[0] == b[0] and _distance(a, b) == 1 and (len(a) != len(b) or sorted(a) == sorted(b))


class Alike:
    """Names among which alike ones are looked for, by what alike names have in common."""

    def __init__(self, names: Iterable[str]) -> None:
        self._all = {name for name in names if not is_partial(name)}
        self._index: defaultdict[object, list[str]] | None = None

    def find(self, name: str) -> list[str]:
        """Return the names that `name` is likely meant to be, sorted; never itself."""
        index, whole = self._indexed(), _whole(name)
        ends = index.get(("end", whole.rpartition("/")[2]), ())
        kinds = (
            index.get(("form", _form(name)), ()),
            [other for other in ends if f"/{_whole(other)}".endswith(f"/{whole}")],
            [other for other in ends if f"/{whole}".endswith(f"/{_whole(other)}")],
        )
        candidates = {other for others in kinds if len(others) <= _COMMON for other in others}
        candidates.update(index.get(("initials", _initials(name)), ()))
        return sorted(candidate for candidate in candidates if alike(name, candidate))

    def _indexed(self) -> defaultdict[object, list[str]]:
        if self._index is None:
            self._index = defaultdict(list)
            for name in self._all:
                self._index["form", _form(name)].append(name)
                self._index["end", _whole(name).rpartition("/")[2]].append(name)
                self._index["initials", _initials(name)].append(name)
        return self._index


@lru_cache(maxsize=16_384)
def words_of(name: str) -> Words:
    """Return the words of each segment of a name, in small letters."""
    return tuple([_segment(segment)[0] for segment in name.split("/") if segment])


@lru_cache(maxsize=16_384)
def _segment(segment: str) -> tuple[tuple[str, ...], str, str]:
    """Return the words of a segment, in small letters, these in the singular as one, and their first letters.

    The names of a system share most of their segments.
    """
    words = tuple([word.lower() for word in _SEPARATORS.split(segment) if word])
    return words, "".join(map(_singular, words)), "".join([word[0] for word in words])


@lru_cache(maxsize=16_384)
def _form(name: str) -> tuple[str, ...]:
    """Return a name without case, separators and plurals; a leading slash stays."""
    root = name[:1] if name[:1] in {"/", "~"} else ""
    return (root, *[_segment(segment)[1] for segment in name.split("/") if segment])


def _singular(word: str) -> str:
    if len(word) > _SHORT - 1 and word.endswith("s") and not word.endswith(("ss", "us", "is")):
        return word[:-1]
    return word


def _tail(longer: str, shorter: str) -> bool:
    """Return whether a name is another without its first namespaces."""
    rest = shorter.removeprefix("~").lstrip("/")
    return bool(rest) and longer != rest and longer.endswith(f"/{rest}")


def _misspelt(one: Words, other: Words) -> bool:
    if len(one) != len(other):
        return False
    pairs = [(a, b) for a, b in zip(one, other, strict=True) if a != b]
    if len(pairs) != 1 or len(pairs[0][0]) != len(pairs[0][1]):
        return False
    words = [(a, b) for a, b in zip(*pairs[0], strict=True) if a != b]
    return len(words) == 1 and _slip(*words[0])


def _slip(one: str, other: str) -> bool:
    """Return whether one word is the other with one typing error, or two where both are long."""
    shorter = min(len(one), len(other))
    if shorter < _SHORT or one[0] != other[0] or not one.isalpha() or not other.isalpha():
        return False
    return _distance(one, other) <= (2 if shorter >= _LONG else 1)


def _distance(one: str, other: str) -> int:
    """Return the number of letters to insert, delete, replace or swap with their neighbour."""
    # Optimal string alignment (Damerau-Levenshtein without repeated edits), of which three rows are needed at a time.
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, a in enumerate(one, 1):
        older, before, row = before, row, [i]
        for j, b in enumerate(other, 1):
            best = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (a != b))
            if i > 1 and j > 1 and a == other[j - 2] and one[i - 2] == b:
                best = min(best, older[j - 2] + 1)
            row.append(best)
    return row[-1]


def _whole(name: str) -> str:
    return name.removeprefix("~").strip("/")


@lru_cache(maxsize=16_384)
def _initials(name: str) -> str:
    """Return the first letters of all words, which a misspelt name shares."""
    return "/".join([_segment(segment)[2] for segment in name.split("/") if segment])


class Related:
    """An index of names by their rest without a word or two, or without a namespace."""

    def __init__(self, names: Iterable[str]) -> None:
        self._whole: defaultdict[Words, list[str]] = defaultdict(list)
        self._parts: defaultdict[Words, list[str]] = defaultdict(list)
        self._ordered: defaultdict[tuple[str, ...], list[str]] = defaultdict(list)
        for name in sorted({name for name in names if not is_partial(name)}):
            words = words_of(name)
            self._whole[words].append(name)
            self._ordered[_ordered(words)].append(name)
            for part in _parts(words):
                self._parts[part].append(name)

    def find(self, name: str) -> list[str]:
        """Return the names that have more to them than `name`, or less, or the same in another order, sorted."""
        if is_partial(name):
            return []
        words = words_of(name)
        candidates = {*self._ordered.get(_ordered(words), ())} - {*self._whole.get(words, ())}
        candidates.update(self._parts.get(words, ()))
        for part in _parts(words):
            candidates.update(self._whole.get(part, ()))
        return sorted(candidates - {name})


def related(one: str, other: str) -> bool:
    """Return whether one of two names has words or a namespace that the other lacks, or the same in another order."""
    if is_partial(one) or is_partial(other):
        return False
    words, others = words_of(one), words_of(other)
    if others in _parts(words) or words in _parts(others):
        return True
    return words != others and _ordered(words) == _ordered(others)


def _ordered(words: Words) -> tuple[str, ...]:
    """Return the words of a name in one order, behind those of its last segment, which stay where they are."""
    return *(words[-1] if words else ()), "/", *sorted(word for segment in words[:-1] for word in segment)


def _parts(words: Words) -> Iterator[Words]:
    """Yield the rests without one or two words of a segment, or without a segment that is not the last."""
    for at in range(len(words) - 1):
        yield words[:at] + words[at + 1 :]
    for at, segment in enumerate(words):
        for rest in _shorter(segment):
            yield (*words[:at], rest, *words[at + 1 :])


@lru_cache(maxsize=16_384)
def _shorter(segment: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """Return the rests of the words of a segment without one or two; words with digits stay."""
    if len(segment) > _MOST_WORDS:
        return ()
    return tuple(
        tuple(word for index, word in enumerate(segment) if index not in gone)
        for extra in range(1, min(_MOST_EXTRA, len(segment) - 1) + 1)
        for gone in combinations(range(len(segment)), extra)
        if not any(any(map(str.isdigit, segment[index])) for index in gone)
    )


_ACTION_TOPICS: Final = {"goal": 1, "cancel": 1, "status": 0, "feedback": 0, "result": 0}
"""The topics of an action of ROS 1, and which end of them its server has."""
_TO_LOOK_AT: Final = frozenset({f"sensor_msgs/{name}" for name in ("Image", "CameraInfo", "CompressedImage")})
"""What is offered in many forms for whoever wants to see it, so that nobody has to hear each."""
_COMMON_WORDS: Final = frozenset({"array", "stamped", "list", "info", "state", "data", "with", "covariance"})
_NUMBERS: Final = re.compile("[0-9]+")


class _Channels:
    """The names of one kind: which ends each has, with which types."""

    def __init__(self) -> None:
        self.ends: defaultdict[str, set[int]] = defaultdict(set)
        self.types: defaultdict[str, set[str]] = defaultdict(set)
        self.named: set[str] = set()
        """Those that code of a node names; frameworks make the others."""
        self.chosen: set[str] = set()
        """Those that a launch file gives to an end that takes, by a parameter or a remapping."""

    def met(self) -> Iterator[str]:
        """Yield the names that code of nodes names and that have both ends."""
        return (name for name in self.named if len(self.ends[name]) > 1)

    def pairs(self) -> Iterator[tuple[str, str]]:
        """Yield names of which only one end is there, with alike or related names that have the other."""
        for lacking in (0, 1):
            lonely = sorted(name for name in self.named if self.ends[name] == {1 - lacking})
            if not lonely:
                continue
            names = [name for name in self.named if lacking in self.ends[name]]
            similar, wider = Alike(names), Related(names)
            for name in lonely:
                near = similar.find(name)
                matches = [other for other in near if self._fit(name, other) and not self._both_intended(name, other)]
                matches += [other for other in wider.find(name) if other not in near and self._lost(name, other)]
                for other in matches:
                    yield min(name, other), max(name, other)

    def _both_intended(self, lonely: str, other: str) -> bool:
        """Return whether names differ in namespaces alone, and nobody waits for `other`: then both may be meant."""
        given = self.ends[lonely] == {0}
        return given and len(self.ends[other]) > 1 and (lonely.endswith(other) or other.endswith(lonely))

    def _fit(self, one: str, other: str) -> bool:
        types, others = self.types[one], self.types[other]
        return not types or not others or not types.isdisjoint(others)

    def _lost(self, lonely: str, other: str) -> bool:
        """Return whether names that are only related are likely the two ends of one that was renamed.

        Types have to agree; where both names lack an end, and share a namespace, types that share a word will do, since
        messages are renamed with their topics. A node that publishes more than others need loses nothing: where both
        ends of `other` are there, an additional output is lost only if a launch file chose `other` instead.
        """
        types, others = self.types[lonely], self.types[other]
        additional = len(self.ends[other]) > 1 and other not in self.chosen
        if self.ends[lonely] == {0} and (additional or not types.isdisjoint(_TO_LOOK_AT)):
            return False
        if not types.isdisjoint(others):
            return True
        above = lonely.rpartition("/")[0]
        if len(self.ends[other]) > 1 or not above or above != other.rpartition("/")[0]:
            return False
        return not _type_words(types).isdisjoint(_type_words(others))

    def moved(self, met: set[str]) -> Iterator[tuple[str, str]]:
        """Yield pairs of names that are likely one in the wrong namespace, the smaller name first.

        They differ in their first namespace alone, and each has the end that the other lacks. A part of a system that
        is started in the namespace of another robot meets nobody there. Of systems with many robots, each may lack the
        same: only a name with one possible partner counts, of the same type. One of the two namespaces has no name at
        which anybody meets, or the two differ in numbers (`drone1`, `drone2`).

        `met` are the first namespaces of names at which somebody meets.
        """
        groups: defaultdict[tuple[str, int], list[str]] = defaultdict(list)
        for name in self.named:
            rest = name[1:].partition("/")[2]
            if rest and len(self.ends[name]) == 1:
                groups[rest, min(self.ends[name])].append(name)
        for (rest, side), given in groups.items():
            taken = groups.get((rest, 1), [])
            if side != 0 or not len(given) == len(taken) == 1 or self.types[given[0]].isdisjoint(self.types[taken[0]]):
                continue
            one, other = sorted((given[0], taken[0]))
            spaces = _first_namespace(one), _first_namespace(other)
            if not met.issuperset(spaces) or len({_NUMBERS.sub("", space) for space in spaces}) == 1:
                yield one, other


def _type_words(types: Iterable[str]) -> set[str]:
    """Return the words in the names of types, without packages and what is added to many."""
    return {word for name in types for part in words_of(name.rpartition("/")[2]) for word in part} - _COMMON_WORDS


def near_misses(instances: Iterable[NodeInstance], ros: int) -> tuple[tuple[str, str, str], ...]:
    """Return pairs of names of one kind (kind, name, other name), sorted, each once, the smaller name first."""
    kinds: defaultdict[str, _Channels] = defaultdict(_Channels)
    for instance in instances:
        for end in instance.interfaces:
            if is_known(end.resolved) and end.resolved not in FRAMEWORK:
                _enter(kinds, end, end.resolved, ros)
    met = {_first_namespace(name) for channels in kinds.values() for name in channels.met()}
    pairs = {(kind, *pair) for kind, channels in kinds.items() for pair in channels.pairs()}
    moved = {(kind, *pair) for kind, channels in kinds.items() for pair in channels.moved(met)}
    return tuple(sorted(pairs | moved))


def _enter(kinds: defaultdict[str, _Channels], end: InstanceInterface, name: str, ros: int) -> None:
    kind, side = end.declared.role.channel, 0 if end.declared.role.gives else 1
    channels = kinds[kind]
    channels.ends[name].add(side)
    if end.declared.type is not None:
        channels.types[name].add(end.declared.type)
    if not end.declared.implicit:
        channels.named.add(name)
    if side == 1 and (end.parameter is not None or end.remap is not None):
        channels.chosen.add(name)
    if kind == "action" and ros == 1:
        for part, of_server in _ACTION_TOPICS.items():
            kinds["topic"].ends[f"{name}/{part}"].add(of_server if side == 0 else 1 - of_server)


def _first_namespace(name: str) -> str:
    """Return the first segment of an absolute name that has more than one; else nothing."""
    first, slash, _ = name[1:].partition("/")
    return first if slash else ""
