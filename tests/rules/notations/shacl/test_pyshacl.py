"""SHACL rules infer the same as pySHACL, on shapes graphs and data made up by hypothesis.

Where pySHACL differs from the standard, or cannot be compared, the shapes graphs do not go:

* `sh:nodes` of a path expression is not read, and `sh:intersection` and `sh:filterShape` fail (they are read from the
  data graph, or called with too few arguments); the draft's expressions are unknown to it.
* The inverse of a sequence is walked in the order of the sequence, so `^(p/q)` means `^p/^q`.
* A literal becomes the subject of a triple.
* Rules of deactivated shapes run.
* Rules of one shape are repeated together, so that one of a lower order sees what one of a higher order derived, and a
  condition with negation is tested before what it negates is finished; rules of different shapes are not repeated
  together. So here each shape has an order of its own, and conditions read what shapes before it derived.
"""

from __future__ import annotations

import logging

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from rdflib import Graph
from rules.notations.shacl.running import canonical, evaluated, triples
from rules.notations.shacl.shapes import data, shapes_graphs

pyshacl = pytest.importorskip("pyshacl", reason="pySHACL is a dependency of tests only")


def expanded(shapes: str, given_data: str) -> set[str]:
    """Return the triples of the data with the inferences of pySHACL."""
    graphs = [Graph().parse(data=text, format="turtle") for text in (given_data, shapes)]
    found = pyshacl.shacl_rules(graphs[0], shacl_graph=graphs[1], advanced=True, iterate_rules=True)
    lines = (f"{one.n3()} {two.n3()} {three.n3()} .\n" for one, two, three in found.triples((None, None, None)))
    return canonical(triples("".join(lines)))


@settings(
    max_examples=12,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
)
@given(shapes_graphs(), data())
def test_rules_infer_what_pyshacl_infers(shapes: str, given_data: str) -> None:
    """The data with the inferences is the same graph."""
    logging.getLogger("pyshacl").setLevel(logging.CRITICAL)
    asserted = triples(given_data)
    assert canonical([*asserted, *evaluated(shapes, asserted)]) == expanded(shapes, given_data)
