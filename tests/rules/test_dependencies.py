from __future__ import annotations

import pytest
from pyoxigraph import NamedNode
from rules.forms import atom, atoms, expression, rule

from kg.rules.dependencies import Read, depends, mints, reads
from kg.rules.form import AUXILIARY, Assignment, Atom, EngineBlock, Exists, Filter, TripleTerm, Variable

TERM = TripleTerm(Variable("s"), NamedNode("urn:x:p"), Variable("s"))


@pytest.mark.parametrize(
    ("reader", "head", "expected"),
    [
        ("?x :p ?y", "?a :p ?b", True),
        ("?x :p ?y", "?a :q ?b", False),
        ("?x :p :A", "?x :p :B", False),
        ("?x :p :A", "?x :p ?y", True),
        ("?x ?p ?y", "?a :q :b", True),
        ("?x :p ?x", ":a :p :b", False),
        ("?x :p ?x", ":a :p ?b", True),
        (":a :p :b", "?x :p ?x", False),
        ("?x :p _:b", "?x :p _:b", False),
        ("?x :p ?y", "?x :p _:b", True),
        ("?x :p ?x", "_:a :p _:b", False),
        ("?x :p ?x", "_:a :p _:a", True),
    ],
)
def test_an_atom_depends_on_the_heads_that_it_unifies_with(reader: str, head: str, *, expected: bool) -> None:
    """Constants, repeated variables and new blank nodes can prevent unification."""
    assert depends(atom(reader), atom(head)) is expected


def test_triple_terms_are_unified_part_by_part() -> None:
    """A triple term matches one of the same shape, and no other term."""
    reader = Atom(Variable("x"), NamedNode("urn:x:has"), TERM)
    other = TripleTerm(NamedNode("urn:x:a"), NamedNode("urn:x:p"), NamedNode("urn:x:b"))
    same = TripleTerm(NamedNode("urn:x:a"), NamedNode("urn:x:p"), Variable("o"))
    assert not depends(reader, Atom(Variable("x"), NamedNode("urn:x:has"), other))
    assert depends(reader, Atom(Variable("x"), NamedNode("urn:x:has"), same))
    assert not depends(reader, atom("?x :has :a"))


def test_a_variable_predicate_does_not_read_what_decomposition_introduced() -> None:
    """Auxiliary predicates are not part of the data; by name they are read."""
    head = Atom(Variable("x"), NamedNode(AUXILIARY + "1"), Variable("y"))
    assert not depends(atom("?s ?p ?o"), head)
    assert depends(Atom(Variable("a"), head.predicate, Variable("b")), head)


def test_reads_tell_what_is_negated_and_leave_out_asserted_data() -> None:
    """NOT negates its content, at any depth; a block reads its predicates."""
    block = EngineBlock("…", (), reads=frozenset({NamedNode("urn:x:r")}), monotone=True)
    body = (
        atom("?x :p ?y"),
        atom("?x :q ?y", asserted=True),
        Exists((atom("?y :n ?z"), Exists(atoms("?z :m ?z")))),
        Exists((Exists(atoms("?x :deep ?x")),), negated=True),
        block,
    )
    found = {str(read.atom.predicate): read.negated for read in reads(rule("?x :h ?y", *body))}
    expected = {":p": False, ":n": False, ":m": False, ":deep": True, ":r": False}
    assert found == {f"<urn:x:{name[1:]}>": negated for name, negated in expected.items()}


def test_a_block_that_may_read_anything_reads_every_triple() -> None:
    """A block without predicates acts as an atom of three variables, negated unless it is monotone."""
    (read,) = reads(rule("?x :h ?y", EngineBlock("…", ())))
    assert read == Read(Atom(Variable(".s"), Variable(".p"), Variable(".o")), negated=True)


def test_rules_that_make_terms_are_known() -> None:
    """Blank nodes, computed values and triple terms with variables create terms; constants and tests do not."""
    computed = Assignment(Variable("y"), expression("?x + 1", mints=True))
    assert mints(rule("?x :p _:b", "?x :q ?y"))
    assert mints(rule("?x :p ?y", "?x :q ?z", computed))
    head = (Atom(Variable("s"), NamedNode("urn:x:p"), TERM),)
    assert mints(type(rule("?x :p ?y"))("t", head, (), rule("?x :p ?y").place))
    assert not mints(rule("?x :p ?y", "?x :q ?y", Filter(expression("?x + 1 > 2", mints=True))))
