from __future__ import annotations

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from kg.launch.files.ros2.values import of_object, of_text, quoted

SCALARS = st.one_of(
    st.booleans(), st.integers(), st.floats(-1e6, 1e6).map(lambda number: round(number, 3)), st.text(max_size=20)
)


@given(st.text(max_size=60))
def test_a_quoted_text_reads_as_itself(text: str) -> None:
    """A text written as YAML is parsed to the same text, on one line."""
    written = quoted(text)
    assert "\n" not in written
    if text.isprintable():
        assert yaml.safe_load(written) == text


@given(st.text(max_size=60), st.sampled_from([None, "string", "int", "double", "bool"]))
def test_any_text_is_a_value(text: str, wanted: str | None) -> None:
    """Any text of a parameter can be read, and its value is on one line."""
    value, _ = of_text(text, wanted)
    assert value is None or "\n" not in value


@given(SCALARS)
def test_values_of_python_keep_their_meaning(value: object) -> None:
    """A Python value is written as equivalent YAML."""
    written, kind = of_object(value)
    if written is not None and (not isinstance(value, str) or value.isprintable()):
        assert yaml.safe_load(written) == value
    assert kind == {bool: "bool", int: "int", float: "double", str: "string"}[type(value)]


@pytest.mark.parametrize(
    ("text", "wanted", "expected"),
    [
        ("1", None, ("1", "int")),
        ("1", "double", ("1.0", "double")),
        ("1", "string", ('"1"', "string")),
        ("[1, 2.5]", None, ("[1, 2.5]", "double_array")),
        ("[a, 1]", None, ("[a, 1]", None)),
        ("", None, ('""', "string")),
        ("{}", None, (None, None)),
        ("/{}/scan", None, ("/{}/scan", "string")),
        ("a: b: c", None, ('"a: b: c"', "string")),
        ("true", None, ("true", "bool")),
        ("y", None, ("y", "bool")),
        ("1e-3", None, ("1e-3", "double")),
        ("-.5", None, ("-.5", "double")),
        (".nan", None, (".nan", "double")),
        ("0x1F", None, ("0x1F", "int")),
        ("1_000", None, ("1_000", "string")),
        ("1:30", None, ("1:30", "string")),
    ],
)
def test_texts_are_read_as_yaml_unless_a_type_is_asked_for(
    text: str, wanted: str | None, expected: tuple[str | None, str | None]
) -> None:
    """The value and type of a text equal those in launch."""
    assert of_text(text, wanted) == expected
