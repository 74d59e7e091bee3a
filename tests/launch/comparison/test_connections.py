from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from render.systems import end, instance, system

from kg.facts import Role
from kg.launch.comparison.states import joined, lost_connections

if TYPE_CHECKING:
    from kg.facts import InstanceInterface, NodeInstance


def sign(instance: NodeInstance, end: InstanceInterface) -> str:
    """Return a key of an end independent of its current name."""
    return f"{instance.name} {end.declared.role}"


def test_those_who_give_are_joined_to_those_who_take() -> None:
    """Providers are joined to consumers by kind and name, never a node to itself."""
    laser = instance("/laser", end(Role.PUBLISHES, "/scan"), end(Role.SUBSCRIBES, "/scan"))
    user = instance("/user", end(Role.SUBSCRIBES, "/scan"), end(Role.CLIENTS, "/scan"))
    assert set(joined(system([laser, user]), sign)) == {("/laser", "topic", "/scan", "/user")}


@pytest.mark.parametrize("name", [None, "/{}/scan"])
def test_ends_whose_name_is_not_known_join_nobody(name: str | None) -> None:
    """Two names with unknown parts may differ, so they are not joined."""
    both = instance("/laser", end(Role.PUBLISHES, name)), instance("/user", end(Role.SUBSCRIBES, name))
    assert joined(system(both), sign) == {}


def test_ends_that_are_left_out_join_nobody() -> None:
    """An end without a key, such as an implicit one, is excluded."""
    both = instance("/laser", end(Role.PUBLISHES, "/scan")), instance("/user", end(Role.SUBSCRIBES, "/scan"))
    assert joined(system(both), lambda _one, _end: None) == {}


def test_ends_that_meet_under_another_name_did_not_come_apart() -> None:
    """A renamed channel is not a lost connection; one whose ends no longer meet is."""
    before, renamed, apart = (
        joined(system([instance("/a", end(Role.PUBLISHES, given)), instance("/b", end(Role.SUBSCRIBES, taken))]), sign)
        for given, taken in (("/scan", "/scan"), ("/laser", "/laser"), ("/scan", "/laser"))
    )
    assert list(lost_connections(before, renamed)) == []
    assert list(lost_connections(before, apart)) == [("/a", "topic", "/scan", "/b")]
