"""Quality of service after the overrides that parameters of ROS 2 make.

Source: design.ros2.org/articles/qos_configurability.html; they are named
`qos_overrides.<topic>.<publisher|subscription>[_<id>].<policy>`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from kg.facts import LaunchParameter, Qos, Role
from kg.launch.wiring.values import parsed

_PREFIX: Final = "qos_overrides."
_ENTITIES: Final = {"publisher": Role.PUBLISHES, "subscription": Role.SUBSCRIBES}
_WORDS: Final = ("reliability", "durability", "history", "liveliness")
_DURATIONS: Final = {"deadline": "deadline", "lifespan": "lifespan", "liveliness_lease_duration": "lease_duration"}
_NANOSECONDS: Final = 1_000_000_000


class Overrides:
    """The overrides among the parameters of an instance."""

    def __init__(self, own: Mapping[str, LaunchParameter]) -> None:
        self.names: list[str] = []
        """The parameters that are overrides."""
        self._of: dict[tuple[str, Role], dict[str, Any]] = {}
        for name, parameter in own.items():
            if name.startswith(_PREFIX):
                self.names.append(name)
                self._read(name.removeprefix(_PREFIX), parameter.value)

    def _read(self, rest: str, value: str | None) -> None:
        topic, _, policy = rest.rpartition(".")
        topic, _, entity = topic.rpartition(".")
        role = _ENTITIES.get(entity.partition("_")[0])
        setting = parsed(value)
        if role is None or not topic:
            return
        number = isinstance(setting, int) and not isinstance(setting, bool)
        if (policy in _WORDS and isinstance(setting, str)) or (policy == "depth" and number):
            change: dict[str, object] = {policy: setting}
        elif policy in _DURATIONS and number:
            change = {_DURATIONS[policy]: setting / _NANOSECONDS}
        else:
            return
        self._of.setdefault((topic, role), {}).update(change)

    def applied(self, declared: Qos | None, topic: str | None, role: Role) -> Qos | None:
        """Return the quality of service in force at one end of a topic with an absolute name."""
        change = self._of.get((topic or "", role)) if self._of else None
        return replace(declared or Qos(), **change) if change else declared
