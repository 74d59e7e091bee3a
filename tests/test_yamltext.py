"""YAML that nests too deep is rejected before it is composed."""

from __future__ import annotations

import pytest
import yaml

from kg.yamltext import Walk, YamlFault, compose_yaml


@pytest.mark.parametrize("mark", ["[", "{a: ", "- ", "? "])
def test_deep_nesting_is_an_error(mark: str) -> None:
    """Text that would overflow the stack of the parser is rejected as invalid YAML."""
    with pytest.raises(YamlFault):
        compose_yaml(mark * 200_000)


def test_wide_text_is_composed() -> None:
    """Many adjacent collections are not deep nesting."""
    node = compose_yaml(f"[{'[1], ' * 3000}[2]]")
    assert isinstance(node, yaml.SequenceNode)
    assert len(node.value) == 3001


def test_nothing_is_none() -> None:
    """A text without a document has no node."""
    assert compose_yaml("# nothing\n") is None


def test_aliases_that_double_are_a_fault() -> None:
    """Walking a document stops when its aliases expand beyond a limit."""
    node = compose_yaml(
        "\n".join(["a0: &a0 {x: 1}", *(f"a{n}: &a{n} {{l: *a{n - 1}, r: *a{n - 1}}}" for n in range(1, 40))])
    )
    walk = Walk()

    def read(below: yaml.Node | None, depth: int) -> None:
        for _, value in walk.pairs(below, depth):
            read(value, depth + 1)

    with pytest.raises(YamlFault, match="endlessly") as caught:
        read(node, 0)
    assert caught.value.is_large


def test_a_fault_has_its_line() -> None:
    """A fault is reported with its line."""
    with pytest.raises(YamlFault, match="is not YAML") as caught:
        compose_yaml("a:\n  b: [1, 2\nc: }\n")
    assert caught.value.line == 3


def test_a_second_document_is_named() -> None:
    """The fault of a text with two documents is a whole sentence, at the line where the second begins."""
    with pytest.raises(YamlFault, match="expected a single document in the stream, but found another") as caught:
        compose_yaml("a: 1\n---\nb: 2\n")
    assert caught.value.line == 2
