from __future__ import annotations

import pytest
from pyoxigraph import Literal, NamedNode

from kg.rules.engine.terms import spell

XSD = "http://www.w3.org/2001/XMLSchema#"


@pytest.mark.parametrize(
    ("text", "datatype", "spelt"),
    [
        ("1", "nonNegativeInteger", b'"1"^^<%sinteger>'),
        ("01", "integer", b'"1"^^<%sinteger>'),
        ("1.50", "decimal", b'"1.5"^^<%sdecimal>'),
        ("1", "boolean", b'"true"^^<%sboolean>'),
        ("one", "integer", b'"one"^^<%sinteger>'),
    ],
)
def test_constants_are_spelt_as_a_store_gives_them_back(text: str, datatype: str, spelt: bytes) -> None:
    """A store keeps values: a constant of a rule that is written otherwise still meets its data."""
    assert spell(Literal(text, datatype=NamedNode(XSD + datatype))) == spelt % XSD.encode()
