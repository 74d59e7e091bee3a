from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.holes import (
    ANONYMOUS,
    Hole,
    anonymous,
    escape,
    filled,
    fits,
    hole_of,
    is_known,
    is_partial,
    known_letters,
    label_of,
    parse,
    partition,
    substitute,
    written,
)

LABELS = st.sampled_from(["", "name", "argv[1]", "a_b"])
TEXTS = st.text("ab/~.{}", min_size=1, max_size=5)
PARTS = st.lists(TEXTS | LABELS.map(Hole), max_size=6)
NAMES = PARTS.map(written)
VALUES = st.text("xy", min_size=1, max_size=3)


def merged(parts: list[str | Hole]) -> tuple[str | Hole, ...]:
    """Return parts without adjacent known ones."""
    found: list[str | Hole] = []
    for part in parts:
        if isinstance(part, str) and found and isinstance(found[-1], str):
            found[-1] += part
        else:
            found.append(part)
    return tuple(found)


@given(PARTS)
def test_what_is_written_is_read_back(parts: list[str | Hole]) -> None:
    """Written names are parsed back: known parts keep their braces, holes their labels."""
    assert parse(written(parts)) == merged(parts)


@given(st.text("a{}[1]/", max_size=10))
def test_any_text_has_one_spelling(text: str) -> None:
    """An unescaped text can be parsed, and writing it twice equals writing it once."""
    once = written(parse(text))
    assert written(parse(once)) == once


@given(TEXTS)
def test_an_escaped_text_has_no_hole(text: str) -> None:
    """An escaped brace of a name is not an unknown part."""
    assert is_known(escape(text))
    assert parse(escape(text)) == (text,)


@given(NAMES)
def test_a_name_fits_itself_with_values_in_its_holes(name: str) -> None:
    """A name matches itself with values in its holes; holes of one label have the same value."""
    values = {"name": "front", "argv[1]": "left", "a_b": "x1"}
    concrete = substitute(name, lambda label: values.get(label, "other"))
    assert fits(name, "".join(part for part in parse(concrete) if isinstance(part, str)))


@given(NAMES)
def test_a_name_without_holes_fits_only_itself(name: str) -> None:
    """A known name matches only itself."""
    known = filled(name, "v")
    plain = "".join(part for part in parse(known) if isinstance(part, str))
    assert fits(known, plain)
    assert not fits(known, plain + "v")


@given(NAMES, VALUES)
def test_substitution_leaves_no_hole_with_a_value(name: str, value: str) -> None:
    """Holes without a value remain after a substitution."""
    found = substitute(name, {"name": value}.get)
    assert Hole("name") not in parse(found)
    assert [part for part in parse(found) if isinstance(part, Hole)] == [
        part for part in parse(name) if isinstance(part, Hole) and part.label != "name"
    ]


@given(NAMES, LABELS)
def test_a_partition_keeps_the_name(name: str, label: str) -> None:
    """The part before the first hole has no hole; the three parts together are the name."""
    before, hole, after = partition(name, f"{{{label}}}")
    assert before + hole + after == name
    assert bool(hole) is is_partial(name)
    assert is_known(partition(name)[0])


@given(NAMES)
def test_labels_are_all_that_anonymous_names_lack(name: str) -> None:
    """Without labels a name has the same holes in the same places."""
    assert parse(anonymous(name)) == tuple(part if isinstance(part, str) else Hole() for part in parse(name))
    assert known_letters(anonymous(name)) == known_letters(name)


@pytest.mark.parametrize(
    ("name", "concrete"),
    [("camera/{}", "camera/left"), ("camera/{name}", "camera/left"), ("{a}{b}/x", "n/x"), ("{name}/{name}", "a/a"),
     ("{}/{}", "a/b"), ("{{name}}", "{name}")],
)  # fmt: skip
def test_a_hole_stands_for_one_segment(name: str, concrete: str) -> None:
    """Adjacent holes are one unknown part; an escaped brace is a brace."""
    assert fits(name, concrete)


@pytest.mark.parametrize(
    ("name", "concrete"), [("camera/{}", "camera/a/b"), ("{name}/{name}", "a/b"), ("{{name}}", "left"), ("a{}", "a")]
)
def test_a_name_that_does_not_fit(name: str, concrete: str) -> None:
    """A hole matches at least one letter and no slash, and one label has one value."""
    assert not fits(name, concrete)


@pytest.mark.parametrize(
    ("source", "label"),
    [("name", "name"), ("name_", "name"), ("_name", "name"), ("~/frame_prefix", "frame_prefix"),
     ("camera.topic", "camera_topic"), ("argv[1]", "argv[1]"), ("argv[1][]", "argv[1]"), ("argv[--topic|-t]", "topic"),
     ("~/topics[].name", "topics_name"),
     ("~/{name}/topic", "topic"), ("i", ""), ("node", ""), ("", ""), ("{}", ""), ("3d", ""), ("a" * 60, "a" * 40)],
)  # fmt: skip
def test_a_label_is_made_of_what_would_give_the_part(source: str, label: str) -> None:
    """Variables, parameters and arguments give labels; single letters and words with another meaning do not."""
    assert label_of(source) == label
    assert hole_of(source) == (f"{{{label}}}" if label else ANONYMOUS)


@given(st.text(max_size=60))
def test_a_label_can_be_written(source: str) -> None:
    """A hole with any label is parsed back."""
    assert parse(hole_of(source)) == (Hole(label_of(source)),)
