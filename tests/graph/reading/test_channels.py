"""Tests of reading one name: the same ends as in complete systems and complete node types."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from workspaces import example

from kg.graph.iris import DEFAULT_BASE, Iris
from kg.graph.reading.channels import CLASSES, ends_in_code, names, names_written, systems_at
from kg.graph.reading.nodes import node_records
from kg.graph.reading.parameters import set_parameters
from kg.graph.reading.systems import started_names, system_names, systems
from kg.graph.usual_ends import unstated_ends
from kg.holes import is_known
from kg.settings import load
from kg.store.opening import reading

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.facts import InstanceInterface, System
    from kg.store.snapshot import EmbeddedSnapshot


@pytest.fixture(scope="module")
def snapshot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EmbeddedSnapshot]:
    """A snapshot of the store of the example workspace."""
    with reading(load({"store": str(example(tmp_path_factory) / ".kg")}, environment={})) as found:
        yield found


def _ends(found: list[System]) -> dict[tuple[str, str, str], set[InstanceInterface]]:
    """Return the ends of systems by system, instance and launch line, regardless of the order of their causes."""
    return {
        (system.configuration.name, one.name, str(one.started.location)): set(one.interfaces)
        for system in found
        for one in system.instances
        if one.interfaces
    }


@pytest.mark.parametrize("kind", CLASSES)
def test_one_name_gives_the_ends_of_whole_systems(snapshot: EmbeddedSnapshot, kind: str) -> None:
    """For each name the instances, and their ends at it, equal those from reading all systems."""
    whole = systems(snapshot, system_names(snapshot), DEFAULT_BASE)
    every = {end.resolved for one in whole for each in one.instances for end in each.interfaces}
    of_kind = [name for name in names(snapshot, kind, implicit=True) if name in every]
    assert len(of_kind) > 1
    for name in of_kind:
        expected = [
            replace(
                system,
                instances=tuple(
                    replace(
                        one,
                        interfaces=tuple(
                            end for end in one.interfaces if end.resolved == name and end.declared.role.channel == kind
                        ),
                    )
                    for one in system.instances
                ),
            )
            for system in whole
        ]
        assert _ends(systems_at(snapshot, kind, name, DEFAULT_BASE)) == _ends(expected)


@pytest.mark.parametrize("kind", CLASSES)
def test_one_name_gives_the_ends_of_all_code(snapshot: EmbeddedSnapshot, kind: str) -> None:
    """For each name of a node started alone the interfaces equal those of the node types."""
    expected: dict[str, set[object]] = {}
    for record in node_records(snapshot):
        for end in record.node.interfaces:
            if end.role.channel == kind and end.resolved and is_known(end.resolved):
                expected.setdefault(end.resolved, set()).add((record.reference, end))
    assert expected
    for name, ends in expected.items():
        assert set(ends_in_code(snapshot, kind, name, DEFAULT_BASE)) == ends


def test_names_in_the_code_lead_to_those_in_systems(snapshot: EmbeddedSnapshot) -> None:
    """A written name leads to its forms by namespaces, remappings and starting its node alone."""
    assert names_written(snapshot, "topic", "cmd_vel") == ["/cmd_vel", "/rover1/mux/cmd_vel"]
    assert names_written(snapshot, "service", "cmd_vel") == []


def test_names_of_frameworks_are_there_on_request(snapshot: EmbeddedSnapshot) -> None:
    """Services of every ROS 2 node are excluded by default."""
    assert "/drone1/gimbal/get_parameters" not in names(snapshot, "service")
    assert "/drone1/gimbal/get_parameters" in names(snapshot, "service", implicit=True)


def _set(snapshot: EmbeddedSnapshot, name: str) -> set[tuple[str, str | None, str, str | None]]:
    """Return name, value, place and node of the settings of a name in files."""
    return {
        (one.absolute, one.value, str(one.location), one.start.name if one.start else None)
        for one in set_parameters(snapshot, name)
    }


def test_parameters_of_one_name_are_those_of_whole_systems(snapshot: EmbeddedSnapshot) -> None:
    """Settings in files are the same, with place and start, as from reading all systems."""
    whole = systems(snapshot, system_names(snapshot), DEFAULT_BASE)
    own = {
        (p.name, p.set.value, str(p.set.location), one.name)
        for s in whole
        for one in s.instances
        for p in one.parameters
    }
    shared = {(p.name, p.value, str(p.location), None) for s in whole for p in s.shared_parameters}
    assert own
    for name in {name for name, *_ in own | shared}:
        expected = {row for row in own | shared if row[0] == name}
        assert _set(snapshot, name) == expected
        for relative in {name.removeprefix(f"{start}/") for *_, start in expected if start}:
            assert expected <= _set(snapshot, relative)
    assert _set(snapshot, "/nowhere/rate") == set()


def test_usual_ends_of_one_name_are_those_of_all(snapshot: EmbeddedSnapshot) -> None:
    """An implicit end looked up by name equals that from reading all of them."""
    every = unstated_ends(snapshot)
    names = {end.name for end in every}
    assert len(names) > 1
    for name in {*names, "/", "/nowhere/at_all"}:
        assert sorted(unstated_ends(snapshot, name), key=str) == sorted(
            (end for end in every if end.name == name), key=str
        )


def test_systems_of_some_iris_have_the_names_of_these(snapshot: EmbeddedSnapshot) -> None:
    """The names of some configurations are the same as among all."""
    every = system_names(snapshot)
    iris = Iris(DEFAULT_BASE)
    one = every[0]
    assert system_names(snapshot, [iris.configuration(one.repository, one.path)]) == [one]
    assert system_names(snapshot, []) == []
    assert system_names(snapshot, named=[one.name]) == [each for each in every if each.name == one.name]


def test_starts_of_one_name_are_those_among_all(snapshot: EmbeddedSnapshot) -> None:
    """The starts of an instance are the same looked up alone or among all."""
    every = started_names(snapshot)
    assert len(every) > 1
    assert all(started_names(snapshot, name) == {name: found} for name, found in every.items())
    assert started_names(snapshot, "/nowhere") == {}
