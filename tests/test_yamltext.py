"""YAML that nests too deep is refused before it is composed."""

from __future__ import annotations

import pytest
import yaml

from kg.yamltext import compose_yaml

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@pytest.mark.parametrize("mark", ["[", "{a: ", "- ", "? "])
def test_deep_nesting_is_an_error(mark: str) -> None:
    """Text that would overrun the stack of the parser is refused as if it were no YAML."""
    with pytest.raises(yaml.YAMLError):
        compose_yaml(mark * 200_000, LOADER)


def test_wide_text_is_composed() -> None:
    """Many collections beside each other are no deep nesting."""
    node = compose_yaml(f"[{'[1], ' * 3000}[2]]", LOADER)
    assert isinstance(node, yaml.SequenceNode)
    assert len(node.value) == 3001


def test_nothing_is_none() -> None:
    """A text without a document has no node."""
    assert compose_yaml("# nothing\n", LOADER) is None
