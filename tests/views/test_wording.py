from __future__ import annotations

import pytest

from kg.facts import Interface, Location, Qos, Resolution, Role
from kg.render.conditions import condition
from kg.views.wording import how

HERE = Location("a.cpp", 1)


@pytest.mark.parametrize(
    ("switches", "words"),
    [
        ((), ""),
        (("use_imu", "fast"), "if use_imu and fast"),
        (("!quiet", "!slow"), "unless quiet or slow"),
        (("!mode == scan", "mode == cloud", "!level == 2"), "if mode is cloud, unless level is 2"),
    ],
)
def test_conditions_of_interfaces_are_put_in_words(switches: tuple[str, ...], words: str) -> None:
    """A condition names parameters; a value excludes the other values of its parameter."""
    assert condition(switches) == words


def test_a_parameter_that_its_reason_names_is_not_repeated() -> None:
    """An unknown name has its reason, which already contains the parameter."""
    reason = "it is the parameter ~/topic, which has no default here"
    end = Interface(Role.SUBSCRIBES, None, None, Resolution.UNRESOLVED, HERE, parameter="~/topic", reason=reason)
    assert how(end) == "the parameter ~/topic, which has no default here"


@pytest.mark.parametrize(
    ("resolution", "words"),
    [(Resolution.LITERAL, ""), (Resolution.CONSTANT, ""), (Resolution.PARTIAL, "partial: `side` is not known")],
)
def test_only_names_that_are_not_known_in_full_are_explained(resolution: Resolution, words: str) -> None:
    """A name from a constant is as certain as a literal one, so nothing is said about it."""
    reason = "`side` is not known" if resolution is Resolution.PARTIAL else None
    assert how(Interface(Role.PUBLISHES, "scan", None, resolution, HERE, reason=reason)) == words


def test_use_of_ends_is_put_in_words() -> None:
    """A publisher without messages, a subscription that ignores them, and parts that messages lack, are named."""
    silent = Interface(Role.PUBLISHES, "odom", None, Resolution.LITERAL, HERE, silent=True)
    partial = Interface(Role.PUBLISHES, "odom", None, Resolution.LITERAL, HERE, unset=("orientation", "twist"))
    ignored = Interface(Role.SUBSCRIBES, "odom", None, Resolution.LITERAL, HERE, ignored=True)
    assert how(silent) == "never published"
    assert how(ignored) == "ignored"
    assert how(partial) == "without orientation and twist"


def test_known_policies_of_qos_are_listed() -> None:
    """Policies that are not known are left out, durations have their unit."""
    assert (
        str(Qos("reliable", "volatile", "keep_last", 5, deadline=0.1))
        == "reliable, volatile, keep_last 5, deadline 0.1 s"
    )
    assert str(Qos(depth=5)) == "depth 5"
