"""`kg instances` of a recorded running system."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robot.live.seen import ADDRESS, ROVER

from kg.facts import Role
from kg.robot.live.keeping import Keeper
from kg.robot.live.systems import is_implicit
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from cli.program import Program


def test_what_was_seen_of_a_running_node_is_counted(kg: Program) -> None:
    """A node without a known type has the topics and services observed, and no `?/?`."""
    store = EmbeddedStore.create(kg.folder / ".kg")
    settings = load({"store": str(kg.folder / ".kg")}, environment={}, folder=kg.folder)
    Keeper(store, settings, address=ADDRESS, name="rover").keep(ROVER)
    run = kg("instances", "robot/rover")
    head, *rows = (line.split("\t") for line in run.out.splitlines())
    told = {row[0]: dict(zip(head, row, strict=True)) for row in rows}
    assert told.keys() == {node.name for node in ROVER.nodes}
    for name, row in told.items():
        for column, role in (("pub", Role.PUBLISHES), ("sub", Role.SUBSCRIBES), ("srv", Role.SERVICES)):
            seen = {one for one in ROVER.ends if (one.node, one.role) == (name, role)}
            assert row[column] == str(sum(not is_implicit(role, one.name, name, ROVER.ros) for one in seen))
        assert row["node"] == "(not known)"
        assert row["par"] == ""
