from __future__ import annotations

import pytest

from kg.facts import LaunchParameter, Location, Qos, Role
from kg.launch.wiring.interfaces import Overrides

LINE = Location("a.launch.py", 3)
DECLARED = Qos(reliability="reliable", depth=10)


def overrides(**values: str | None) -> Overrides:
    """Return the overrides of policies for the publisher of `/scan`."""
    named = {f"qos_overrides./scan.publisher.{policy}": value for policy, value in values.items()}
    return Overrides({name: LaunchParameter(name, value, LINE) for name, value in named.items()})


def test_policies_take_the_place_of_those_declared() -> None:
    """Words and the depth are used unchanged, durations are converted from nanoseconds; other policies remain."""
    found = overrides(
        reliability="best_effort", depth="5", deadline="1500000000", liveliness_lease_duration="2000000000"
    )
    expected = Qos(reliability="best_effort", depth=5, deadline=1.5, lease_duration=2.0)
    assert found.applied(DECLARED, "/scan", Role.PUBLISHES) == expected
    assert found.applied(None, "/scan", Role.PUBLISHES) == expected
    assert len(found.names) == 4


def test_what_an_override_is_not_for_stays() -> None:
    """Another topic, the other end of the topic, and a topic with an unknown name keep the declared policies."""
    found = overrides(depth="5")
    for topic, role in (("/other", Role.PUBLISHES), ("/scan", Role.SUBSCRIBES), (None, Role.PUBLISHES)):
        assert found.applied(DECLARED, topic, role) == DECLARED


@pytest.mark.parametrize(
    ("policy", "value"),
    [("depth", "many"), ("depth", "true"), ("depth", "1.5"), ("depth", None), ("deadline", "fast"),
     ("deadline", "false"), ("reliability", "3"), ("colour", "5"), ("colour", "red")],
)  # fmt: skip
def test_what_is_no_value_of_a_policy_changes_nothing(policy: str, value: str | None) -> None:
    """A value of another type, an unknown one, and an unknown policy are ignored."""
    assert overrides(**{policy: value}).applied(DECLARED, "/scan", Role.PUBLISHES) == DECLARED
