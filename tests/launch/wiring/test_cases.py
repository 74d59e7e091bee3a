"""Systems as files: started nodes and node types, with the resulting graph."""

from __future__ import annotations

from pathlib import Path

import pytest
from wiring.systems_of import read_case, seen

CASES = sorted((Path(__file__).parent / "cases").glob("*.toml"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_configuration_gives_the_expected_graph(path: Path) -> None:
    """Types, names, remappings, parameters and plugins of each instance equal those of the case."""
    system, expected = read_case(path)
    assert seen(system) == expected
