"""SHACL rules by cases: each folder of `cases` has rules, data, and the triples that they infer, all in Turtle."""

from __future__ import annotations

from pathlib import Path

import pytest
from rules.shacl.running import canonical, evaluated, triples

CASES = sorted((Path(__file__).parent / "cases").iterdir())


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_rules_infer_what_the_case_expects(case: Path) -> None:
    """The rules infer the expected triples and no others."""
    shapes, data, expected = ((case / f"{name}.ttl").read_text() for name in ("rules", "data", "expected"))
    assert canonical(evaluated(shapes, triples(data))) == canonical(triples(expected))
