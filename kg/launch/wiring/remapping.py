"""Remapping of names, by the rules of roscpp and rospy (ROS 1) and of rcl (ROS 2).

Both compare absolute names: the left side of a rule is resolved for the node, and it fits a name that it equals. What a
rule gives is not remapped again. In ROS 1 a node handle's namespace is a name that rules fit as well
(`ros::NodeHandle::construct`), and names of actions are namespaces of handles; rules of a nodelet's manager count where
none of its own fits. In ROS 2 a rule can be for topics or services alone and for nodes of one name.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.facts import Remap, Role
from kg.holes import ANONYMOUS, is_partial

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.launch.wiring.place import Place

ACTIONS: Final = (Role.ACTION_SERVERS, Role.ACTION_CLIENTS)
_SERVICES: Final = (Role.SERVICES, Role.CLIENTS)
_SCHEMES: Final = {"rostopic://": "topic", "rosservice://": "service"}
_UNKNOWN: Final = f"/{ANONYMOUS}"
_PARTS: Final = {
    1: (("goal", "topic"), ("cancel", "topic"), ("status", "topic"), ("feedback", "topic"), ("result", "topic")),
    2: (
        ("_action/send_goal", "service"),
        ("_action/cancel_goal", "service"),
        ("_action/get_result", "service"),
        ("_action/feedback", "topic"),
        ("_action/status", "topic"),
    ),
}
"""What an action is made of on the wire, below its name."""


@dataclass(frozen=True, slots=True)
class Rule:
    """A remapping with both sides absolute; `only` is `topic` or `service` where it is for these alone.

    A name that is empty until somebody gives it, by an argument of the launch file, is unknown.
    """

    source: str
    target: str
    remap: Remap
    only: str | None = None


def rules_of(remaps: Sequence[Remap], place: Place, ros: int) -> tuple[Rule, ...]:
    """Return the rules of a node, in their order.

    Those that rename the node itself (`__node`, `__ns`) and those for nodes of another name are left out.
    """
    rules = (_rule(remap, place, ros) for remap in remaps if not remap.source.startswith("__"))
    return tuple(rule for rule in rules if rule is not None)


def _rule(remap: Remap, place: Place, ros: int) -> Rule | None:
    if ros == 1:
        return Rule(place.resolve(remap.source), place.resolve(remap.target) if remap.target else _UNKNOWN, remap)
    written, node, only = remap.source, "", None
    scheme = next((prefix for prefix in _SCHEMES if prefix in written), None)
    if scheme is not None:
        node, _, written = written.partition(scheme)
        node, only = node.removesuffix(":"), _SCHEMES[scheme]
    elif ":" in written:
        node, _, written = written.partition(":")
    if node not in {"", place.name}:
        return None
    target = remap.target
    for prefix in _SCHEMES:
        target = target.removeprefix(prefix)
    return Rule(place.expand(written, ros), place.expand(target, ros) if target else _UNKNOWN, remap, only)


class Remapping:
    """The rules in force for an instance; `used` collects those that changed a name."""

    def __init__(self, rules: Sequence[Rule], ros: int) -> None:
        self._ros = ros
        self._rules: dict[tuple[str, str], Rule] = {}
        self.used: set[Remap] = set()
        for rule in rules:
            if not is_partial(rule.source):
                for kind in ("topic", "service") if rule.only is None else (rule.only,):
                    self._rules.setdefault((kind, rule.source), rule)

    def __bool__(self) -> bool:
        return bool(self._rules)

    def apply(self, name: str, role: Role, handle: str | None = None) -> tuple[str, Remap | None]:
        """Return the remapped name of an absolute one, and the remapping that matches, if any.

        `handle` is the absolute namespace of the node handle that the name was given to (ROS 1), if it is known.
        """
        if not self._rules:
            return name, None
        if role in ACTIONS:
            return self._action(name)
        kind = "service" if role in _SERVICES else "topic"
        through = self._rules.get((kind, handle)) if handle else None
        if through is not None and handle is not None and name.startswith(f"{handle}/"):
            moved, last = self._one(kind, _below(through.target, name.removeprefix(handle)))
            self.used.add(through.remap)
            return moved, last or through.remap
        return self._one(kind, name)

    def parameter(self, name: str) -> str:
        """Return the name that a parameter of ROS 1 is looked up by: rules fit those, too."""
        return self._one("topic", name)[0] if self._ros == 1 and self._rules else name

    def _one(self, kind: str, name: str) -> tuple[str, Remap | None]:
        rule = self._rules.get((kind, name))
        if rule is None:
            return name, None
        self.used.add(rule.remap)
        return rule.target, rule.remap

    def _action(self, name: str) -> tuple[str, Remap | None]:
        """Rename an action: by a rule for its name, or by rules that move all of its parts below one other name."""
        whole = self._rules.get(("topic", name)) or self._rules.get(("service", name))
        base = whole.target if whole is not None else name
        parts = [self._rules.get((kind, _below(base, part))) for part, kind in _PARTS[self._ros]]
        for rule in (whole, *parts):
            if rule is not None:
                self.used.add(rule.remap)
        first = parts[0]
        ends = [part for part, _ in _PARTS[self._ros]]
        if first is not None and first.target.endswith(f"/{ends[0]}"):
            moved = first.target.removesuffix(f"/{ends[0]}")
            targets = [rule.target for rule in parts if rule is not None]
            if targets == [_below(moved, end) for end in ends]:
                return moved or "/", first.remap
        return base, whole.remap if whole is not None else None


def _below(name: str, rest: str) -> str:
    return f"{name.rstrip('/')}/{rest.lstrip('/')}"
