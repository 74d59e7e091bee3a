"""Tests of the content of ontology/function.ttl."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import ontologies
from rdflib import RDF, RDFS, Namespace

if TYPE_CHECKING:
    from rdflib.term import Node

RNKG: Final = Namespace("https://w3id.org/rnkg/ns#")
ONTOLOGY: Final = ontologies.named()["function"]
SIGNS: Final = sorted(set(ONTOLOGY.subjects(RDF.type, RNKG.Sign)), key=str)
FUNCTIONS: Final = set(ONTOLOGY.subjects(RDF.type, RNKG.Function))


def _weights(sign: Node) -> list[int]:
    return [int(str(weight)) for weight in ONTOLOGY.objects(sign, RNKG.weight)]


def test_every_sign_has_one_weight_for_one_function() -> None:
    """Two signs of one name would be merged, with both weights for the words of both."""
    assert len(SIGNS) > 2 * len(FUNCTIONS)
    for sign in SIGNS:
        assert len(_weights(sign)) == 1, sign
        assert len(list(ONTOLOGY.objects(sign, RDFS.label))) == 1, sign
        assert len(FUNCTIONS.intersection(ONTOLOGY.objects(sign, RNKG.indicates))) == 1, sign


def test_every_function_has_a_sign_for_it() -> None:
    """A function without a sign could never be inferred."""
    positive = [sign for sign in SIGNS if min(_weights(sign)) > 0]
    assert {one for sign in positive for one in ONTOLOGY.objects(sign, RNKG.indicates)} == FUNCTIONS
