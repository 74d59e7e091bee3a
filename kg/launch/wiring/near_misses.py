"""Names of a system that are likely meant to be one: one of them has no other end, and the other name has."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Final

from kg.facts import InstanceInterface, NodeInstance
from kg.holes import is_known
from kg.launch.wiring.similar_names import Alike, Related, words_of
from kg.names import FRAMEWORK

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.facts import InstanceInterface, NodeInstance

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
