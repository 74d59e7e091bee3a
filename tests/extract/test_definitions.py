from __future__ import annotations

import string
from typing import TYPE_CHECKING

from extract.workspaces import codes, reader_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.extract.definitions import read_definitions

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

    from kg.facts import Field, InterfaceDefinition, Problem


def read(root: Path, files: dict[str, str | bytes]) -> tuple[tuple[InterfaceDefinition, ...], tuple[Problem, ...]]:
    """Return the definitions of a package with these files, and the problems with them."""
    reader = reader_of(root, files)
    return read_definitions(reader, reader.package), reader.problems


def fields(root: Path, text: str, path: str = "msg/Thing.msg") -> tuple[Field, ...]:
    """Return the fields of a package's only definition."""
    (definition,), _ = read(root, {path: text})
    return definition.fields


def test_fields_have_their_type_line_default_and_comment(tmp_path: Path) -> None:
    """A field has its line, its default and its trailing comment; comment lines are not fields."""
    found = fields(tmp_path, '# about\n\nstd_msgs/Header header\nstring name "a#b"  # what it is called\n')
    assert [(f.section, f.name, f.type, f.line, f.default, f.comment) for f in found] == [
        ("message", "header", "std_msgs/Header", 3, None, None),
        ("message", "name", "string", 4, "a#b", "what it is called"),
    ]


def test_types_are_written_as_package_and_type(tmp_path: Path) -> None:
    """A type without a package is the package's own, `Header` is that of std_msgs; bounds and times are unchanged."""
    lines = (
        "Pose a\nHeader b\ntime[] c\nduration d\nbuiltin_interfaces/Time e\nstring<=4 f\nuint8[<=3] g\nfloat64[9] h"
        "\ntimestamps/Stamp i\nwstring j\nwstring<=3[] k\ngeometry_msgs/msg/Point l"
    )
    assert [f.type for f in fields(tmp_path, lines)] == [
        "demo/Pose",
        "std_msgs/Header",
        "time[]",
        "duration",
        "builtin_interfaces/Time",
        "string<=4",
        "uint8[<=3]",
        "float64[9]",
        "timestamps/Stamp",
        "wstring",
        "wstring<=3[]",
        "geometry_msgs/Point",
    ]


def test_constants_of_ros1_may_have_any_name_and_strings_end_with_the_line(tmp_path: Path) -> None:
    """`uint8 mixedCase=4` is a constant, and a `#` belongs to the value of a string constant (wiki.ros.org/msg)."""
    found = fields(tmp_path, 'uint8 FOO=0x10 # sixteen\nuint32 mixedCase = 4 # four\nstring S= a "b" # c\nstring E=\n')
    assert [(f.name, f.constant, f.comment) for f in found] == [
        ("FOO", "16", "sixteen"),
        ("mixedCase", "4", "four"),
        ("S", 'a "b" # c', None),
        ("E", "", None),
    ]


def test_services_and_actions_have_sections(tmp_path: Path) -> None:
    """The parts around `---` belong to request and response, or goal, result and feedback."""
    service = fields(tmp_path, "bool a\n---\nbool b\n", "srv/Ask.srv")
    action = fields(tmp_path / "other", "bool a\n---\n---\nbool c\n", "action/Go.action")
    assert [(f.section, f.name) for f in service] == [("request", "a"), ("response", "b")]
    assert [(f.section, f.name) for f in action] == [("goal", "a"), ("feedback", "c")]


def test_a_bad_line_is_reported_and_hides_nothing(tmp_path: Path) -> None:
    """A line outside the grammar is a problem KG118 with its line; the other lines are read."""
    (definition,), problems = read(tmp_path, {"msg/Bad.msg": "bool a\n;lk jas[dfl;k\nbool b\nbool c maybe so\n"})
    assert [f.name for f in definition.fields] == ["a", "b"]
    assert codes(problems) == [("KG118", 2), ("KG118", 4)]


def test_sections_that_the_kind_does_not_have_are_reported(tmp_path: Path) -> None:
    """A message with `---` is reported, and the rest is not read as fields."""
    (definition,), problems = read(tmp_path, {"msg/Bad.msg": "bool a\n---\nbool b\n"})
    assert [f.name for f in definition.fields] == ["a"]
    assert codes(problems) == [("KG118", 2)]


IDL = """#include "geometry_msgs/msg/Point.idl"
module demo { module msg {
  module Shape_Constants {
    const uint8 BOX = 1;
  };
  struct Shape {
    string<10> label;
    sequence<geometry_msgs::msg::Point> points;
  };
}; };
"""


def test_idl_is_read_with_lines(tmp_path: Path) -> None:
    """An `.idl` message has its constants and fields, each on its line."""
    found = fields(tmp_path, IDL, "msg/Shape.idl")
    assert [(f.name, f.type, f.line, f.constant) for f in found] == [
        ("BOX", "uint8", 4, "1"),
        ("label", "string<=10", 7, None),
        ("points", "geometry_msgs/Point[]", 8, None),
    ]


def test_idl_services_have_sections(tmp_path: Path) -> None:
    """The structs of an `.idl` service become its request and its response."""
    text = "module demo { module srv { struct Ask_Request { boolean a; }; struct Ask_Response { string b; }; }; };"
    assert [(f.section, f.name) for f in fields(tmp_path, text, "srv/Ask.idl")] == [("request", "a"), ("response", "b")]


def test_idl_beyond_the_grammar_is_reported(tmp_path: Path) -> None:
    """Unsupported IDL is a problem, without a definition."""
    definitions, problems = read(tmp_path, {"msg/Odd.idl": "interface X { void call(); };"})
    assert definitions == ()
    assert codes(problems) == [("KG118", 1)]


NAMES = st.text(string.ascii_lowercase, min_size=1, max_size=8)
TYPES = st.sampled_from(["bool", "float64", "string", "uint8[]", "int32[4]", "std_msgs/Header", "Pose"])


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=25, deadline=None
)
@given(lines=st.lists(st.one_of(st.tuples(TYPES, NAMES), st.just(("#", "note")), st.just(("", ""))), max_size=12))
def test_every_field_written_is_found_on_its_line(
    tmp_path_factory: pytest.TempPathFactory, lines: list[tuple[str, str]]
) -> None:
    """Any fields of a message are found once, in order, on their lines."""
    root = tmp_path_factory.mktemp("ws")
    found = fields(root, "\n".join(f"{kind} {name}" for kind, name in lines))
    expected = [(name, number) for number, (kind, name) in enumerate(lines, 1) if kind not in {"#", ""}]
    assert [(f.name, f.line) for f in found] == expected


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=50, deadline=None
)
@given(data=st.binary(max_size=200))
def test_no_bytes_stop_the_reading(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    """For any bytes of a definition, reading gives facts and problems."""
    root = tmp_path_factory.mktemp("ws")
    definitions, _ = read(root, {"msg/Any.msg": data})
    assert len(definitions) <= 1


def test_constants_may_have_spaces_around_their_equals_sign(tmp_path: Path) -> None:
    """A text after `=` is a constant, in quotes or not."""
    found = fields(tmp_path, "string AGE = 0-2\nstring KIND = \"one\"\nstring plain 'two'\nfloat64[] list [1, 2.50]\n")
    assert [(f.name, f.constant, f.default) for f in found] == [
        ("AGE", "0-2", None),
        ("KIND", "one", None),
        ("plain", None, "two"),
        ("list", None, "[1, 2.5]"),
    ]
