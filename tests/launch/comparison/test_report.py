from __future__ import annotations

from render.systems import end, instance, system

from kg.facts import Location, Role
from kg.launch.comparison import Change, Difference, Finding, Kind, Level, Side, Sources, compare
from kg.launch.comparison.report import difference_lines, difference_markdown, difference_objects

PLACE = Location("src/a_b.cpp", 4)
RETYPED = Change(
    Level.INTERFACE, Kind.TYPE, "pkg/n", Side("scan", "a/A", PLACE, "r"), Side("scan", "b/B", PLACE, "r"), "publishes"
)
FOUND = compare(
    Sources(systems=[system([instance("/a", end(Role.PUBLISHES, "/x")), instance("/b")])]),
    Sources(
        systems=[system([instance("/a", end(Role.PUBLISHES, "/x")), instance("/b", end(Role.SUBSCRIBES, "/x"))])],
        findings=[Finding("bringup/launch/robot.launch", "KG401", "/scan", "nobody publishes /scan")],
    ),
)


def test_lines_name_what_changed_where_and_count_it() -> None:
    """Each change has a sign; those of one owner are grouped; the last line counts."""
    assert difference_lines(Difference((RETYPED,))) == [
        "pkg/n",
        "  ~ publishes scan: type a/A -> b/B  src/a_b.cpp:4",
        "",
        "interface 1 changed",
    ]
    lines = difference_lines(FOUND)
    assert "  + /a to /b by topic /x" in lines
    assert "  + KG401 nobody publishes /scan" in lines
    assert lines[-1] == "name in launch files 1 new; connection 1 new; finding 1 new"
    assert difference_lines(Difference()) == ["no differences"]


def test_markdown_is_a_table_with_links() -> None:
    """Changes are formatted as code, which disables Markdown in them; a line without address is text."""
    text = difference_markdown(
        Difference((RETYPED,)), "main..<b`>", lambda side, after: f"https://x/{side.name}#{after}"
    )
    assert "### `main..<b'>`" in text
    assert "| ~ | `publishes scan: type a/A -> b/B` | [`src/a_b.cpp:4`](https://x/scan#True) |" in text
    assert "| `src/a_b.cpp:4` |" in difference_markdown(Difference((RETYPED,)), "x")
    assert "1 more row left out" in difference_markdown(Difference((RETYPED, RETYPED)), "x", most=1)


def test_json_has_both_sides() -> None:
    """Lines and values of before and after are fields."""
    (found,) = difference_objects(Difference((RETYPED,)))
    assert found["level"] == "interface"
    assert found["before"] == {
        "name": "scan",
        "value": "a/A",
        "file": "src/a_b.cpp",
        "line": 4,
        "repository": "r",
    }
