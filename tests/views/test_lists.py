"""Tests of the lists over the whole store."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from lint.robot import read, write

from kg.errors import UsageError
from kg.settings import Settings
from kg.views import answers
from kg.views.listing import listing
from kg.views.lists import LISTS
from kg.views.system import lint

if TYPE_CHECKING:
    from pathlib import Path

    from kg.store.snapshot import EmbeddedSnapshot

_EVERY = pytest.mark.parametrize("of", LISTS)


@_EVERY
def test_each_value_of_a_facet_has_as_many_rows_as_it_says(
    snapshot: EmbeddedSnapshot, settings: Settings, of: str
) -> None:
    """Choosing a value gives as many rows as its count."""
    whole = listing(snapshot, settings, of=of)
    assert whole["total"] == whole["all"] == len(whole["rows"]) > 0
    for name, values in whole["facets"].items():
        for one in values[:3]:
            assert listing(snapshot, settings, of=of, **{name: one["value"]})["total"] == one["count"]


@_EVERY
def test_pages_make_up_the_whole(snapshot: EmbeddedSnapshot, settings: Settings, of: str) -> None:
    """Pages have no gaps, are in the requested order, and are reversed in the other one."""
    key = next(key for key, value in listing(snapshot, settings, of=of)["rows"][0].items() if isinstance(value, str))
    ordered = [one[key] for one in listing(snapshot, settings, of=of, sort=key)["rows"]]
    assert [value.lower() for value in ordered] == sorted(value.lower() for value in ordered)
    paged = [
        one[key]
        for offset in range(0, len(ordered), 3)
        for one in listing(snapshot, settings, of=of, sort=key, offset=str(offset), limit="3")["rows"]
    ]
    assert paged == ordered
    assert listing(snapshot, settings, of=of, sort=f"-{key}")["rows"][-1][key].lower() == ordered[0].lower()


def test_facets_narrow_each_other(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A facet offers the values of rows that match the words and the other facets."""
    found = listing(snapshot, settings, of="nodes", package="rover_robot", kind="script")
    assert {one["package"] for one in found["rows"]} == {"rover_robot"}
    kinds = {one["value"]: one["count"] for one in found["facets"]["kind"]}
    assert sum(kinds.values()) == listing(snapshot, settings, of="nodes", package="rover_robot")["total"]
    assert listing(snapshot, settings, of="nodes", text="ROVER scan_filter")["total"] == 1


def test_whole_nodes_are_those_of_the_command(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Complete nodes are those of `kg nodes --json`, with the IRI."""
    found = listing(snapshot, settings, of="nodes", whole="yes")["rows"]
    lines = answers.node_lines(snapshot)
    assert found == [{**json.loads(one.text), "iri": one.iri} for one in lines]


def test_findings_are_those_of_lint(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The list has the findings of `kg lint`."""
    found = listing(snapshot, settings, of="findings", whole="yes")["rows"]
    assert {one["fingerprint"] for one in found} == {one["fingerprint"] for one in lint(snapshot, settings)["findings"]}


def test_a_finding_is_found_by_each_of_its_launch_files(tmp_path: Path) -> None:
    """The facet of launch files has all in which a finding is, not only the one that it is reported for."""
    settings = Settings(store=write(tmp_path))
    found = listing(read(tmp_path), settings, of="findings", system="bringup/launch/all.launch")["rows"]
    assert {(one["code"], one["system"]) for one in found} == {
        ("KG401", "bringup/launch/base.launch"),
        ("KG412", "bringup/launch/all.launch"),
    }


def test_types_tell_where_they_are_defined(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A type defined by a package of the store is distinguished from one only used."""
    found = {one["name"]: one["defined"] for one in listing(snapshot, settings, of="types")["rows"]}
    assert (found["drone_interfaces/FlightState"], found["nav_msgs/Odometry"]) == ("in this store", "elsewhere")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"of": "nodos"}, "Valid lists: nodes"),
        ({"of": "nodes", "pakage": "x"}, "package"),
        ({"of": "nodes", "sort": "size"}, "Sort by"),
    ],
)
def test_what_is_not_there_is_refused(
    snapshot: EmbeddedSnapshot, settings: Settings, arguments: dict[str, str], named: str
) -> None:
    """An unknown list, filter or key is an error that names the valid ones."""
    with pytest.raises(UsageError) as caught:
        listing(snapshot, settings, **arguments)
    assert caught.value.code == "KG003"
    assert named in (caught.value.hint or "")
