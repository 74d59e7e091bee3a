from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.query.terms import unknown_terms
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

    from kg.store.snapshot import EmbeddedSnapshot

RNKG = "https://w3id.org/rnkg/ns#"
DATA = f"""
<{RNKG}publishes> <http://www.w3.org/1999/02/22-rdf-syntax-ns#type> <http://www.w3.org/2002/07/owl#ObjectProperty> .
<{RNKG}NodeType> <http://www.w3.org/1999/02/22-rdf-syntax-ns#type> <http://www.w3.org/2002/07/owl#Class> .
<urn:n> <{RNKG}name> "n" .
"""


@pytest.fixture
def snapshot(tmp_path: Path) -> EmbeddedSnapshot:
    """Return a store with two defined terms and one that is only used."""
    from pyoxigraph import NamedNode  # noqa: PLC0415 - the fixture alone needs it

    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.append(NamedNode("urn:g"), DATA.encode())
    return store.read()


@pytest.mark.parametrize(
    ("query", "sentences"),
    [
        ("ASK { ?n rnkg:name ?x ; rnkg:publishes ?t ; a rnkg:NodeType }", []),
        ("ASK { ?n rnkg:publshes ?t }", ["`rnkg:publshes` is not in the store. Did you mean `rnkg:publishes`?"]),
        ("ASK { ?n a rnkg:Nodetype }", ["`rnkg:Nodetype` is not in the store. Did you mean `rnkg:NodeType`?"]),
        ("ASK { ?n skos:zzz ?t . ?m skos:zzz ?t }", ["`skos:zzz` is not in the store."]),
        ("PREFIX rnkg: <urn:x> ASK { ?n <urn:p> 'rnkg:zzz' # rnkg:zzz\n }", []),
        ('ASK { ?n rnkg:name "1"^^xsd:zzz }', []),
    ],
)
def test_misspelt_terms_are_named_with_what_was_meant(
    snapshot: EmbeddedSnapshot, query: str, sentences: list[str]
) -> None:
    """Names in code are looked up, those in texts, comments and datatypes are not; each is reported once."""
    assert unknown_terms(snapshot, query) == sentences
