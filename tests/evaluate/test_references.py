from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.errors import UsageError
from kg.evaluate.references import Entry, plain_name, plain_type, read, readme_nodes, short_name

CASES = Path(__file__).parent / "cases"
JSON: st.SearchStrategy[Any] = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=8,
)
KEYS = st.sampled_from(["repo", "package", "node", "publishes", "params", "closed_world", "scorable", "commit"])


def test_both_shapes_of_records_are_read() -> None:
    """Objects and pairs give the same entries; unscored ones, and those without a package, are counted."""
    found = read(CASES / "truth.jsonl")
    scan, mission, *_ = found.references
    assert scan.closed == {"publishes", "subscribes", "services"}
    assert Entry("publishes", "scan_cloud", "sensor_msgs/LaserScan") in scan.entries
    assert Entry("parameters", "min_range", None) in scan.entries
    assert mission.repository == "local/field"
    assert Entry("action_clients", "fly_to", "drone_interfaces/FlyToAction") in mission.entries
    assert Entry("publishes", "ground/*/report", "std_msgs/String") in mission.entries
    assert found.left_out == {"no package is named": 1, "excluded by the file": 1}


def test_lines_about_one_node_belong_together(tmp_path: Path) -> None:
    """A node of several lines, one for each launch file, counts once with all its references."""
    line = {"repo": "a/b", "package": "p", "executable": "x"}
    path = tmp_path / "two.jsonl"
    lines = [
        {**line, "publishes": [["a", None]], "node_name": "one"},
        {**line, "publishes": [["a", None], ["b", None]]},
    ]
    path.write_text("\n".join(map(json.dumps, lines)))
    (found,) = read(path, closed=True).references
    assert [entry.name for entry in found.entries] == ["a", "b"]
    assert found.names == {"x", "one"}
    assert "parameters" in found.closed


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "invalid reference"),
        ("[]", "invalid reference"),
        ('{"package": "p"}', "names no repository"),
        ('{"repo": "a/b", "publishes": 3}', "invalid reference"),
        ("[" * 100_000, "invalid reference"),
    ],
)
def test_a_line_that_is_no_reference_is_named(tmp_path: Path, text: str, words: str) -> None:
    """The error has the line."""
    path = tmp_path / "bad.jsonl"
    path.write_text(f'{{"repo": "a/b", "package": "p"}}\n{text}\n')
    with pytest.raises(UsageError, match=words) as raised:
        read(path)
    assert raised.value.place is not None
    assert raised.value.place.line == 2


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    """A missing file, or one that is not UTF-8, is an error with the path."""
    (tmp_path / "latin.jsonl").write_bytes(b"\xff\xfe")
    for name in ("none.jsonl", "latin.jsonl"):
        with pytest.raises(UsageError, match="cannot be read"):
            read(tmp_path / name)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.dictionaries(KEYS, JSON))
def test_any_json_is_read_or_refused(tmp_path: Path, record: dict[str, Any]) -> None:
    """Any JSON line is read, or rejected with KG721."""
    path = tmp_path / "any.jsonl"
    path.write_text(json.dumps({"repo": "a/b", **record}))
    with suppress(UsageError):
        read(path)


@given(st.text(alphabet="#|-`*[]() \n~:/abInput Name Type Parameters", max_size=300))
def test_any_page_is_read(text: str) -> None:
    """Any Markdown page is parsed, and its entries have names."""
    assert all(entry.name for node in readme_nodes(text) for entry in node.entries)


def test_tables_and_lists_of_a_readme() -> None:
    """Headings give the role and the node; other tables, code and invalid names are skipped."""
    found = readme_nodes((CASES / "readme.md").read_text("utf-8"))
    named = {node.name: [(entry.kind, entry.name, entry.type) for entry in node.entries] for node in found}
    assert named == {
        "flight_controller": [
            ("subscribes", "imu/data", "sensor_msgs::msg::Imu"),
            ("subscribes", "~/input/odom", "nav_msgs/msg/Odometry"),
            ("publishes", "state", "drone_interfaces/FlightState"),
            ("parameters", "gains.p", None),
            ("parameters", "motors", None),
        ],
        "drone_control": [
            ("subscribes", "~/input/image", "sensor_msgs/Image"),
            ("publishes", "~/output/image", "sensor_msgs/Image"),
        ],
    }


@pytest.mark.parametrize(
    ("name", "plain"),
    [("~/a", "a"), ("~a", "a"), ("/a/b/", "a/b"), ("/", None), (None, None), ("a?", None), ("<n>/{x}b", "*/*b")],
)
def test_plain_names(name: str | None, plain: str | None) -> None:
    """Names are compared without marks of private and absolute names, holes as stars."""
    assert plain_name(name) == plain


def test_plain_types_and_short_names() -> None:
    """Types and names of nodes have one spelling."""
    assert {plain_type(one) for one in ("a/B", "a/msg/B", "a::msg::B", "a.msg.B")} == {"a/B"}
    assert plain_type("B") is None
    assert [short_name(one) for one in ("a::B", "a/b.py", "B")] == ["b", "b", "b"]
