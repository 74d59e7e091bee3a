from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from repository import ROOT
from search.store import CONTENT

import kg
from kg.errors import UsageError
from kg.search.index import build
from kg.search.searching import Search, hit_object

if TYPE_CHECKING:
    from pathlib import Path

SEARCH: Final = Search(build(CONTENT))


def _found(text: str = "", filters: dict[str, list[str]] | None = None) -> list[str]:
    return [hit.name for hit in SEARCH.find(text, filters).hits]


def test_the_node_that_does_it_comes_first() -> None:
    """Words of names and descriptions find a node; so do synonyms."""
    assert _found("merge the scans of two lasers into one")[0] == "scan_merger_node"
    assert _found("combine range scans of lidars")[0] == "scan_merger_node"
    assert _found("turn a laser scan into a point cloud")[0] == "ScanToCloud"


def test_variants_and_copies_are_one_hit() -> None:
    """The nodelet of a program, and its copy elsewhere, belong to one hit; the maintained one is shown."""
    hit = SEARCH.find("merge laser scans").hits[0]
    assert hit.package.iri == "p:lasers"
    assert {node.iri for _, node in hit.others} == {
        "https://example.org/merger-nodelet",
        "https://example.org/merger-copy",
    }
    assert _found("merge laser scans").count("scan_merger_node") == 1


def test_hits_say_why_with_a_line() -> None:
    """Each reason of a hit is a part of its score, with the line that shows it."""
    why = [str(reason) for reason in SEARCH.find("merge the scans of two lasers into one").hits[0].why]
    assert "publishes sensor_msgs/LaserScan at src/node.cpp:12" in why
    assert any(text.startswith("named scan_merger_node at src/merger.cpp:3") for text in why)
    assert any(text.startswith("a comment says “Merges the scans") for text in why)


@pytest.mark.parametrize(
    ("filters", "expected"),
    [
        ({"subscribes": ["LaserScan"]}, {"scan_merger_node", "ScanToCloud"}),
        ({"subscribes": ["sensor_msgs/LaserScan"], "publishes": ["PointCloud2"]}, {"ScanToCloud"}),
        ({"services": ["SetBool"]}, {"camera_driver"}),
        ({"hardware": ["camera"]}, {"camera_driver"}),
        ({"hardware": ["webcam"]}, {"camera_driver"}),
        ({"hardware": ["sensor"]}, {"camera_driver", "scan_merger_node"}),
        ({"function": ["data processing"]}, {"scan_merger_node", "ScanToCloud"}),
        ({"capability": ["see"]}, {"camera_driver"}),
        ({"ros": ["2"]}, {"camera_driver", "ScanToCloud"}),
        ({"license": ["bsd"]}, {"scan_merger_node"}),
        ({"kind": ["script"]}, {"camera_driver"}),
        ({"package": ["clouds"]}, {"camera_driver", "ScanToCloud"}),
        ({"function": ["hardware"], "ros": ["1"]}, set()),
    ],
)
def test_filters_leave_out_what_does_not_fulfil_them(filters: dict[str, list[str]], expected: set[str]) -> None:
    """Every filter applies, with or without words; types may be abbreviated, classes broader or synonyms."""
    assert set(_found("", filters)) == expected
    assert set(_found("anything else", filters)) == expected


@pytest.mark.parametrize(
    ("kind", "value", "code", "hint"),
    [
        ("subscribes", "LaserScam", "KG701", "LaserScan"),
        ("hardware", "camra", "KG702", "camera"),
        ("license", "Apache-3.0", "KG703", "Apache-2.0"),
        ("kind", "daemon", "KG703", "script"),
    ],
)
def test_unknown_names_are_refused_with_near_ones(kind: str, value: str, code: str, hint: str) -> None:
    """A filter that no node fulfils is an error with suggestions."""
    with pytest.raises(UsageError) as caught:
        SEARCH.find("", {kind: [value]})
    assert caught.value.code == code
    assert hint in (caught.value.hint or "")


@given(st.text(max_size=60))
@settings(max_examples=40)
def test_any_text_can_be_searched_for(text: str) -> None:
    """Every text has a deterministic result, in order of decreasing score, that is valid JSON."""
    answer = SEARCH.find(text)
    assert answer == SEARCH.find(text)
    assert [hit.score for hit in answer.hits] == sorted((hit.score for hit in answer.hits), reverse=True)
    json.dumps([hit_object(hit) for hit in answer.hits])


def test_a_program_finds_nodes_in_a_store(tmp_path: Path) -> None:
    """`kg.find` reads a built store, caches its index, and detects changes of the store."""
    store = tmp_path / "store"
    kg.build([ROOT / "examples" / "workspace" / "rover"], store=store, jobs=1)
    hits = kg.find("remove far measurements from laser scans", store=store)
    assert hits[0]["node"] == "scan_filter"
    assert any(text.startswith("subscribes sensor_msgs/LaserScan at ") for text in hits[0]["why"])
    (kept,) = (store / "cache" / "search").iterdir()
    assert kg.find("remove far measurements from laser scans", store=store) == hits
    kg.build([ROOT / "examples" / "workspace" / "drone"], store=store, jobs=1)
    assert kg.find("point the camera of a drone", store=store)[0]["package"] == "drone_control"
    assert not kept.exists()
