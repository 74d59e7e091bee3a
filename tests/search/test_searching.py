from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from repository import ROOT
from search.store import CONTENT

import kg
from kg.errors import UsageError
from kg.search.documents import End
from kg.search.folding import groups
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


def test_usage_of_a_package_finds_its_nodes() -> None:
    """Words of a README's sections find nodes; the reason cites the sentence that has them."""
    first = SEARCH.find("thermometer").hits[0]
    assert first.package.name == "clouds"
    (why,) = map(str, first.why)
    assert why == "a page says “… Then plug in the thermometer, whose readings colour the image.” at README.md:20"


def test_a_program_that_finds_transforms_in_called_code_belongs_to_its_nodelet() -> None:
    """Transforms, which are found by calls, keep no program and the nodelet that it loads apart."""
    loaded = replace(
        CONTENT.nodes[1],
        name="Detector",
        plugin="clouds/Detector",
        ends=(*CONTENT.nodes[1].ends, End("publishes", "/tf", "tf2_msgs/TFMessage", "src/tf.cpp", 3)),
    )
    program = replace(CONTENT.nodes[0], name="continuous_node", executable="continuous_node")
    assert groups(CONTENT.packages, [program, loaded]).tolist() == [0, 0]


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


def test_the_usage_of_a_package_is_about_its_nodes_if_they_are_few(tmp_path: Path) -> None:
    """A README's sections are searched for the nodes of a small package, but not for those of a large one."""
    for package, count in (("few", 1), ("many", 9)):
        folder = tmp_path / "source" / package
        (folder / "scripts").mkdir(parents=True)
        (folder / "package.xml").write_text(f"<package><name>{package}</name></package>")
        (folder / "README.md").write_text(f"# {package}\n\n## Steps\n\nAdjust the thermometer before it starts.\n")
        for place in range(count):
            script = folder / "scripts" / f"{package}_{place}.py"
            script.write_text("#!/usr/bin/env python\nimport rospy\nrospy.init_node('one')\n")
            script.chmod(0o755)
    kg.build([tmp_path / "source"], store=tmp_path / "store", jobs=1)
    assert [hit["package"] for hit in kg.find("thermometer", store=tmp_path / "store")] == ["few"]
