"""The examples of the rules shipped with `kg`, each a case; `kg rules test` runs them the same way."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import pytest

from kg import resources
from kg.rules.authoring.examples import read_examples
from kg.rules.authoring.library import Library
from kg.rules.authoring.testing import run_example

if TYPE_CHECKING:
    from kg.rules.authoring.examples import Example

LIBRARY: Final = Library([resources.folder("rules")])
EXAMPLES: Final = [
    pytest.param(name, example, id=f"{name}: {example.title}")
    for name, entry in LIBRARY.entries.items()
    if entry.examples.is_file()
    for example in read_examples(entry.examples)
]


@pytest.mark.parametrize(("name", "example"), EXAMPLES)
def test_example(name: str, example: Example) -> None:
    """The rule infers the triples of its example."""
    result = run_example(LIBRARY.read(name), example, LIBRARY)
    assert result.passed, result


@pytest.mark.parametrize("name", LIBRARY.entries)
def test_every_rule_has_examples(name: str) -> None:
    """Each rule has a page with examples next to it."""
    assert LIBRARY.entries[name].examples.is_file()
