"""Tests of the errors in descriptions of framework calls; the shipped ones and the manual have none."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from repository import ROOT

from kg.symbolic import columns
from kg.symbolic.checking import check
from kg.symbolic.descriptions import merged

if TYPE_CHECKING:
    from kg.errors import SourceError

CALL = '[[call]]\nin = ["acme"]\nname = "f"\n'
METHOD = '[[call]]\non = ["acme::Node"]\nname = "f"\n'
CLASS = '[[class]]\nname = "acme::Node"\n'


def errors_of(*texts: str) -> list[SourceError]:
    """Return the errors in some files, called 0.toml, 1.toml and so on."""
    return check({f"{index}.toml": text for index, text in enumerate(texts)})


def test_shipped_descriptions_have_no_errors() -> None:
    """The rows of ontology/calls satisfy the rules for users' rows."""
    files = sorted((ROOT / "ontology" / "calls").glob("*.toml"))
    assert check({str(file): file.read_text(encoding="utf-8") for file in files}) == []


@pytest.mark.parametrize(
    ("text", "line", "column", "message", "hint"),
    [
        ("ros = 3\n", 1, 1, "`ros` is 3", "0, 1 or 2"),
        ("row = 1\n", 1, 1, "`row` is not a key of a file", "`ros`"),
        ("[call]\n", 1, 2, "`call` is not a list of tables", "[[call]]"),
        ('ros = 1\n[[call]]\nname = "f\n', 3, 10, "this is not TOML", "syntax"),
        (CALL + 'publshes = { name = 0, type = ["template"] }', 4, 1, "`publshes` is not a column", "`publishes`"),
        (CLASS + 'returns = "self"', 3, 1, "`returns` is not a column of [[class]]", ""),
        (CALL + 'publishes = { name = 0, typ = ["template"] }', 4, 25, "`typ` is not a key of `publishes`", "`type`"),
        (CALL + "publishes = { name = 0, output = 1 }", 4, 25, "`output` is not a key of `publishes`", "Use one of"),
        (CALL + "reads = { name = 0, qos = 1 }", 4, 21, "`qos` is not a key of `reads`", "Use one of"),
        (CALL + "publishes = { qos = 0 }", 4, 1, "`publishes` has no name", "`fixed`"),
        (CALL + 'publishes = { name = 0, type = "template" }', 4, 25, "`type` is 'template'", "list of texts"),
        (CALL + "arguments = 2", 4, 1, "`arguments` is 2", "[1, 2]"),
        (CALL + "arguments = [3, 2]", 4, 1, "`arguments` is [3, 2]", "fewest"),
        (CALL + "arguments = [1, 2]\nreads = { name = 2 }", 5, 11, "no argument 2: the call has at most 2", "from 0"),
        (CALL + "arguments = [1, 1]\nnode = 1", 5, 1, "no argument 1: the call has at most 1 argument", "from 0"),
        (CALL + 'arguments = [1, 2]\nreturns = "argument:1"', 5, 11, "only 1", "from 0"),
        (CALL + 'arguments = [1, 2]\nreturns = "path"', 5, 1, "no argument 1", "from 0"),
        (CALL + "slot = { clas = 0 }", 4, 10, "`clas` is not a key of `slot`", "`class`"),
        (CALL + "slot = { name = 0 }", 4, 1, "`slot` names no plugins", "`base`"),
        (CALL + "slot = 0", 4, 1, "`slot` is 0", "a table"),
        (CALL + "arguments = [1, 1]\nslot = { class = 1 }", 5, 10, "no argument 1", "from 0"),
        (CALL + 'arguments = [1, 1]\nslot = { class = 0, base = "f<{1}>" }', 5, 21, "no argument 1", "from 0"),
        (CALL + "copies = [0, 1]", 4, 1, "no argument 0: the call can have only 0", "from 0"),
        (CALL + 'publishes = { name = 0, type = ["tmplate"] }', 4, 33, '"tmplate" is not a source', "`template`"),
        (CALL + 'publishes = { name = 0, type = ["callback"] }', 4, 33, '"callback" is not a source', "`callback:N`"),
        (CALL + 'publishes = { name = 0, type = ["text:x"] }', 4, 33, "has no argument number", "text:0"),
        (CALL + 'returns = "paramter"', 4, 11, '"paramter" is not a result', "`parameter`"),
        (CALL + 'returns = "duration:ms"', 4, 11, '"duration:ms" has no number of seconds', "0.001"),
        (CALL + 'mark = "tf.listner"', 4, 1, '"tf.listner" is not a mark', "`tf.listener`"),
        (CALL + "options = true", 4, 1, "`options` but no interface", "subscribes"),
        ('[[call]]\nname = "f"\n', 1, 1, "matches no call", "`on"),
        ('[[call]]\nin = ["name"]\n', 1, 1, "the row has no `name`", "name ="),
        ('[[call]]\non = ["ros::NodeHandel"]\nname = "f"', 2, 7, "no [[class]] describes it", "`ros::NodeHandle`"),
        ('[[call]]\non = ["A"]\nname = "f"', 2, 7, "no [[class]] describes it", "[[class]]"),
        (CLASS + 'is = "nod"', 3, 6, '"nod" is not a kind of object', "`node`"),
        (CLASS + 'is = "value"', 3, 6, '"value" is not a kind of object', "`value:N`"),
        (CLASS + 'like = "nodelet::Nodlet"', 3, 1, "no [[class]] describes it", "`nodelet::Nodelet`"),
        (CLASS + 'gives = [{ method = "init", arguments = 1 }]', 3, 1, "`gives` has no `handles`", "namespaces"),
        (CLASS + 'gives = [{ methd = "init" }]', 3, 12, "`methd` is not a key of `gives`", "`method`"),
    ],
)
def test_an_error_has_its_place_and_a_way_out(text: str, line: int, column: int, message: str, hint: str) -> None:
    """Each kind of error is found, at its line and column, with a correction."""
    error = errors_of(text)[0]
    assert (error.code, message in error.message) == ("KG123", True), error
    assert error.place is not None
    assert (error.place.path, error.place.line, error.place.column) == ("0.toml", line, column)
    assert error.hint is not None
    assert hint in error.hint


def test_all_errors_are_found_in_the_order_of_the_files() -> None:
    """One error does not hide later ones, in the same row, another row, or another file."""
    first = CLASS + 'is = "nod"\n' + CALL + "arguments = 1\nnodes = 0\n"
    places = [error.place for error in errors_of(first, "[[call]]\n")]
    assert [(place.path, place.line) for place in places if place] == [
        ("0.toml", 3),
        ("0.toml", 7),
        ("0.toml", 8),
        ("1.toml", 1),
    ]


@pytest.mark.parametrize(
    ("earlier", "later"),
    [
        (CALL, CALL),
        (CALL, CALL + "arguments = [1, 1]\n"),
        ('[[call]]\nin = ["*"]\nname = ["e", "f"]\n', CALL),
        (CALL + "arguments = [0, 1]\n" + CALL + "arguments = [2, 3]\n", CALL + "arguments = [1, 2]\n"),
        (CLASS, CLASS),
        ('[[class]]\nname = "Node"\n', CLASS),
        (CLASS + METHOD, METHOD),
        (
            CLASS + '[[class]]\nname = "acme::Own"\nlike = "acme::Node"\n' + METHOD,
            '[[call]]\non = ["acme::Own"]\nname = "f"\n',
        ),
    ],
)
def test_a_row_that_never_matches_is_an_error(earlier: str, later: str) -> None:
    """A row after one that matches the same calls, or the same class, has no effect and is reported."""
    assert errors_of(earlier) == []
    for texts in ((earlier + later,), (earlier, later)):
        (error,) = errors_of(*texts)
        assert error.code == "KG124"
        assert "the row at 0.toml:" in error.message


@pytest.mark.parametrize(
    ("earlier", "later"),
    [
        (CALL + "arguments = [0, 1]\n", CALL),
        (CALL, '[[call]]\nin = ["acme", "other"]\nname = "f"\n'),
        (CLASS + METHOD, CALL),
        (CLASS, '[[class]]\nname = "Node"\n'),
        (CALL, '[[call]]\nin = ["*"]\nname = "f"\n'),
    ],
)
def test_a_row_that_matches_something_else_is_right(earlier: str, later: str) -> None:
    """A wider row after a narrower one has its effect."""
    assert errors_of(earlier + later) == []


@pytest.mark.parametrize(
    ("heading", "known"),
    [
        ("## Functions and methods: `[[call]]`", columns.CALL),
        ("## Classes: `[[class]]`", columns.CLASS),
        ("| `is` | kind of object |", columns.KINDS),
        ("## Effects", {**columns.INTERFACE, **columns.PARAMETER}),
        ("| `type` | the message type", columns.TYPES),
        ("### Plugins", columns.SLOT),
        ("## Results", columns.RESULTS),
    ],
)
def test_the_manual_lists_every_column_and_word(heading: str, known: dict[str, object]) -> None:
    """Each table of docs/calls.md has exactly the supported columns and words."""
    page = (ROOT / "docs" / "calls.md").read_text(encoding="utf-8")
    table = re.search(r"(?:^\|.*\n)+", page[page.index(heading) :], re.MULTILINE)
    assert table is not None
    cells = [line.split("|")[1] for line in table[0].splitlines()[2:]]
    words = {name for cell in cells for name in re.findall(r"`([^`]+)`", cell)}
    listed = {name.partition(":")[0] for name in words if "/" not in name and "::" not in name}
    roles = {name for name in known if known[name] is columns.CALL["publishes"]}
    assert listed | roles == set(known)


WORDS = st.sampled_from(
    [
        *columns.CALL,
        *columns.CLASS,
        *columns.INTERFACE,
        *columns.PARAMETER,
        *columns.SLOT,
        "class",
        "call",
        "ros",
        "template",
        "acme::A",
    ]
)
VALUES = st.recursive(
    st.one_of(
        st.booleans(), st.integers(-1, 3), st.just(1.5), WORDS, st.sampled_from(["value:1", "argument:0", "*", ""])
    ),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(WORDS, inner, max_size=3)),
    max_leaves=4,
)
ROWS = st.lists(st.tuples(st.sampled_from(["call", "class"]), st.dictionaries(WORDS, VALUES, max_size=5)), max_size=4)


def written(value: object) -> str:
    """Return a value in TOML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f'"{key}" = {written(one)}' for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(written, value)) + "]"
    return str(value).lower() if isinstance(value, bool) else f'"{value}"' if isinstance(value, str) else str(value)


@given(ROWS)
def test_what_is_checked_can_be_read(rows: list[tuple[str, dict[str, object]]]) -> None:
    """Any content of a file is either reported with its place or read."""
    text = "".join(
        f"[[{kind}]]\n" + "".join(f'"{key}" = {written(value)}\n' for key, value in row.items()) for kind, row in rows
    )
    errors = errors_of(text)
    assert all(error.place is not None and error.place.line is not None and error.hint for error in errors)
    if not errors:
        merged((text,))
