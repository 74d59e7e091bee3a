from __future__ import annotations

from pathlib import Path

import pytest
from pyoxigraph import RdfFormat, parse
from rules.engine.comparing import inferred
from rules.engine.oracle import Fact, infer

from kg.rules.reading import read

CASES = sorted((Path(__file__).parent / "cases").glob("*.srl"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_case_infers_the_triples_beside_it(path: Path) -> None:
    """The engine and the naive evaluation infer the triples in the file of that name from the file's data."""
    file = read(path, f"cases/{path.stem}")
    quads = parse(path.with_suffix(".nt").read_bytes(), RdfFormat.N_TRIPLES)
    expected = {(quad.subject, quad.predicate, quad.object) for quad in quads}
    data: set[Fact] = {(triple.subject, triple.predicate, triple.object) for triple in file.data}
    assert inferred(file.rules, data) == expected
    assert infer(file.rules, data) == expected
