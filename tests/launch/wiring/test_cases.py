"""Systems as files: what is started and which node types there are, with the graph that comes of it."""

from __future__ import annotations

from pathlib import Path

import pytest
from wiring.systems_of import read_case, seen

CASES = sorted((Path(__file__).parent / "cases").glob("*.toml"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_configuration_gives_the_expected_graph(path: Path) -> None:
    """Types, names, remappings, parameters and plugins of each instance are those that the case expects."""
    system, expected = read_case(path)
    assert seen(system) == expected
