from __future__ import annotations

import numpy as np
import pytest
from pyoxigraph import BlankNode, Literal, NamedNode
from rules.forms import expression

from kg.rules.engine import expressions
from kg.rules.engine.expressions import Expressions, text_test
from kg.rules.engine.limits import Clock, Limits
from kg.rules.engine.tables import Table
from kg.rules.engine.terms import Dictionary

XSD = "http://www.w3.org/2001/XMLSchema#"
TERMS = [
    NamedNode(XSD + "integer"),
    NamedNode("urn:lidar_1"),
    BlankNode("lidar"),
    Literal("lidar_node"),
    Literal("a lidar"),
    Literal("Lidar"),
    Literal("lidar\n"),
    Literal("lidar", language="en"),
    Literal(7),
    Literal(""),
    Literal("a.b"),
    Literal("axb"),
    Literal("7", datatype=NamedNode(XSD + "decimal")),
    Literal('li"dar'),
    Literal("lidär"),
    Literal("^lidar_(node|driver)$"),
    Literal("a\\.b"),
    Literal("[^a-z"),
]


FILTERS = [
    f"DATATYPE( ?x ) = <{XSD}string>",
    f"DATATYPE( ?x ) != <{XSD}integer>",
    "DATATYPE( ?x ) = ?y ",
    "DATATYPE( ?x ) = <http://www.w3.org/1999/02/22-rdf-syntax-ns#langString>",
    'REGEX( ?x , "lidar")',
    'REGEX( ?x , "^lidar_(node|driver)$")',
    'REGEX(STR( ?x ), "^urn:")',
    'REGEX( ?x , "a\\\\.b")',
    'REGEX( ?x , "r$")',
    'REGEX( ?x , "[^a-z]")',
    'REGEX( ?x , "^[a-z ]*$")',
    'REGEX( ?x , "a.b")',
    'REGEX( ?x , "")',
    'CONTAINS( ?x , "lid")',
    'STRSTARTS(STR( ?x ), "urn:l")',
    'STRENDS( ?x , "dar")',
    'CONTAINS(STR( ?x ), "7")',
    "REGEX( ?x , ?y )",
    "REGEX(STR( ?y ), ?x )",
    "CONTAINS( ?x , ?y )",
    "STRSTARTS(STR( ?x ), ?y )",
    "STRENDS( ?x , ?y )",
    "STRENDS( ?x , ?x )",
    "CONTAINS( ?x , ?z )",
    " ?x = ?y ",
    " ?x != ?y ",
    "( ?x = <urn:lidar_1>)",
    " ?x != <urn:other>",
    "sameTerm( ?x , ?y )",
    "!sameTerm( ?x , ?y )",
    "isIRI( ?x )",
    "!isBlank( ?x )",
    "isLiteral( ?x )",
    "BOUND( ?x )",
    "!BOUND( ?x )",
    " ?x IN (<urn:lidar_1>, <urn:b>)",
    " ?x NOT IN (<urn:lidar_1>)",
    "(( ?x = ?y ))",
    "(sameTerm( ?x , ?y ))",
    "( ?x = ?y ) || ( ?x != <urn:lidar_1>)",
    '(REGEX( ?x , "(r)$"))',
]


def table(dictionary: Dictionary) -> Table:
    """Return all pairs of terms."""
    found = dictionary.intern_all(str(term).encode() for term in TERMS)
    return Table({"x": np.repeat(found, found.size), "y": np.tile(found, found.size)}, found.size**2)


@pytest.mark.parametrize("text", FILTERS)
def test_what_is_decided_without_the_engine_is_what_it_says(text: str) -> None:
    """Every filter with a shortcut holds for the same terms as by evaluation, with or without brackets."""
    dictionary = Dictionary()
    rows = table(dictionary)
    columns = [("x", "x"), ("y", "y")]
    quick = Expressions(dictionary).holds(expression(text), rows, columns, Clock(Limits()))
    # A conjunction with a true operand has no shortcut.
    slow = Expressions(dictionary).holds(expression(f"({text}) && true"), rows, columns, Clock(Limits()))
    assert quick.tolist() == slow.tolist()


@pytest.mark.parametrize("pattern", ["(a+)+b", "a*a*a*a*", r"\\d", "(?i)a", "[a--b]", "a{2}", r"\\bword"])
def test_patterns_that_dialects_read_differently_are_left_to_the_engine(pattern: str) -> None:
    """Shorthands, flags, nested classes, and repetitions with unbounded time."""
    assert text_test(f'REGEX(?x, "{pattern}")') is None


def test_an_unbound_variable_is_an_error_unless_the_expression_forgives_it() -> None:
    """A variable without a column, or without a value in the row, is unbound in the expression."""
    dictionary = Dictionary()
    rows = Table({"x": np.array([dictionary.intern_term(Literal(1)), 0], np.int64)}, 2)
    computed = Expressions(dictionary)
    for text, expected in (
        ("?x + 1", ["2", None]),
        ("COALESCE( ?x , 5)", ["1", "5"]),
        ("COALESCE( ?z , 6)", ["6", "6"]),
    ):
        values = computed.values(expression(text), rows, [("x", "x")], Clock(Limits()))
        assert [dictionary.term(value).value if value else None for value in values.tolist()] == expected  # type: ignore[union-attr]  # literals


@pytest.mark.parametrize("names", ["x", "xy", "xyz"])
def test_values_are_remembered(names: str) -> None:
    """The same expression over the same terms, in any table, is computed once, whatever the number of variables."""
    dictionary = Dictionary()
    computed = Expressions(dictionary)
    rows = Table({name: dictionary.intern_all([b'"a"', b'"b"', b'"a"']) for name in names}, 3)
    joined = expression(f"UCASE(CONCAT({', '.join(f' ?{name} ' for name in names)}))")
    columns = [(name, name) for name in names]
    first = computed.values(joined, rows, columns, Clock(Limits()))
    computed._store = None  # type: ignore[assignment]  # nobody is asked again
    again = computed.values(joined, rows.take(slice(0, 2)), columns, Clock(Limits()))
    assert again.tolist() == first[:2].tolist()
    expected = [b'"%s"' % (letter * len(names)) for letter in (b"A", b"B", b"A")]
    assert dictionary.spellings(first) == expected


def test_triple_terms_with_blank_nodes_have_values() -> None:
    """VALUES cannot contain a blank node inside of a triple term; a string that looks like one is no blank node."""
    dictionary = Dictionary()
    spelt = [
        "<<( _:b <urn:p> <urn:c> )>>",
        '<<( <urn:a> <urn:p> "_:b" )>>',
        "<<( <urn:a> <urn:p> <<( _:c <urn:p> _:d )>> )>>",
    ]
    rows = Table({"x": dictionary.intern_all(one.encode() for one in spelt)}, len(spelt))
    computed = Expressions(dictionary)
    for text, expected in (
        ("SUBJECT( ?x )", [b"_:b", b"<urn:a>", b"<urn:a>"]),
        ("SUBJECT(OBJECT( ?x ))", [b"", b"", b"_:c"]),
        ("<<( <urn:s> <urn:p> ?x )>>", [b"<<( <urn:s> <urn:p> %s )>>" % one.encode() for one in spelt]),
    ):
        values = computed.values(expression(text), rows, [("x", "x")], Clock(Limits()))
        assert dictionary.spellings(values) == expected


def test_many_rows_are_evaluated_in_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rows of each batch get their values, with and without blank nodes."""
    monkeypatch.setattr(expressions, "_BATCH", 2)
    dictionary = Dictionary()
    terms = dictionary.intern_all([*(b'"%d"' % number for number in range(5)), b"_:a", b"_:b", b"_:c"])
    rows = Table({"x": terms}, terms.size)
    values = Expressions(dictionary).values(
        expression("IF(isBlank( ?x ), 0, STRLEN( ?x ) + 1)"), rows, [("x", "x")], Clock(Limits())
    )
    assert [dictionary.term(value) for value in values.tolist()] == [Literal(2)] * 5 + [Literal(0)] * 3
