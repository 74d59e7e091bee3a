"""Values of expressions: computed by the store's engine, once for each combination of terms.

The combinations that a table has are numbered and handed over as one `VALUES`; results are remembered by the text of
the expression and the identifiers, across rounds and runs. Values that identifiers alone decide need no engine.

Tests of text in filters (REGEX, CONTAINS, STRSTARTS, STRENDS) on the spellings of terms, without the store's engine.

Only tests with certainly the same meaning in both are decided: patterns of ASCII without look-around, shorthands or
flags, on strings without a type or a language, and on IRIs within STR. The rest is left open.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Final, cast

import numpy as np
from pyoxigraph import Literal, NamedNode, Quad, QuerySolutions, Store

from kg.rules import form
from kg.rules.engine.facts import EMPTY, Keys, distinct
from kg.rules.engine.shortcuts import shortcut
from kg.rules.engine.tables import Table, among
from kg.rules.sparql import spelling
from kg.syntax.lexer import bare

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from kg.rules.engine.limits import Clock
    from kg.rules.engine.terms import Dictionary
    from kg.rules.form import Expression

ERROR: Final = 0
"""What stands for the value of an expression in error."""

_VARIABLE: Final = re.compile(r"\?\w+")

_REPEATED: Final = 8
"""A test of two variables is decided here where its second one repeats as often as this."""
_PACKABLE: Final = 2
_BATCH: Final = 20_000
"""Rows in one `VALUES`: the text of a query stays some megabytes."""

OPEN: Final = -1
"""The filter is left to the engine for that term."""

_STRING: Final = r'"([^"\\\n]*(?:\\[\\"][^"\\\n]*)*)"'
_FORM: Final = re.compile(
    rf"\s*(REGEX|CONTAINS|STRSTARTS|STRENDS)\s*\(\s*(?:(STR)\s*\(\s*\?(\w+)\s*\)|\?(\w+))"
    rf"\s*,\s*(?:{_STRING}|\?(\w+))\s*\)\s*",
    re.IGNORECASE,
)
_SPELT: Final = re.compile(_STRING)
# Plain characters, escaped punctuation, simple classes of characters, the dot, groups, alternatives, anchors, and a few
# repetitions of one character: a group that repeats may take time without end here, which it does not there.
_PLAIN: Final = re.compile(
    r"(?:[A-Za-z0-9_ /:#,;=@~%&<>!'-]|\\[.*+?()|^$/\-]|\[\^?[A-Za-z0-9_/.-]+\]|\.|\((?!\?)|\)(?![*+?])|\|"
    r"|[*+?](?![*+?])|\^|\$)*"
)
_STRINGS: Final = re.compile(r'(?:"[^"\n]*"\n)*+"[^"\n]*"')
"""Strings without a type or a language, one on each line."""

_REPETITIONS: Final = 3


@dataclass(frozen=True, slots=True)
class TextTest:
    """One test: `variable` is its argument; `lexical`: STR is around it.

    What the argument is compared with is the value of the variable `other`; None where it is written in the test.
    """

    name: str
    variable: str
    lexical: bool
    other: str | None
    holds: Callable[[str], object] = bool

    def against(self, spelling: bytes) -> TextTest | None:
        """Return the test with a term for its `other` variable; None if only the engine can decide it."""
        match = _SPELT.fullmatch(spelling.decode())
        holds = _holding(self.name, re.sub(r"\\(.)", r"\1", match[1])) if match else None
        return None if holds is None else replace(self, other=None, holds=holds)

    def decide(self, spellings: Sequence[bytes]) -> NDArray[np.int8]:
        """Return for each term whether the test holds (1, 0), or `OPEN`."""
        text = b"\n".join(spellings).decode()
        if "\\" not in text and _STRINGS.fullmatch(text):
            holds = self.holds
            return np.array([bool(holds(line[1:-1])) for line in text.split("\n")], np.int8)
        return np.fromiter(map(self._decided, spellings), np.int8, len(spellings))

    def _decided(self, spelling: bytes) -> int:
        first = spelling[:1]
        if first == b'"':
            if spelling[-1:] != b'"' or b"\\" in spelling:
                return OPEN
            return bool(self.holds(spelling[1:-1].decode()))
        if first == b"<" and spelling[1:2] != b"<":
            return self.lexical and bool(self.holds(spelling[1:-1].decode()))
        return OPEN


@cache
def text_test(text: str) -> TextTest | None:
    """Return the test that the text of an expression is, None when it is none of these."""
    match = _FORM.fullmatch(text)
    if not match:
        return None
    name, lexical, inner, bare, argument, other = match.groups()
    test = TextTest(name.upper(), inner or bare, bool(lexical), other)
    return test if other else test.against(f'"{argument}"'.encode())


@lru_cache(maxsize=1024)
def _holding(name: str, argument: str) -> Callable[[str], object] | None:
    if name == "CONTAINS":
        return lambda value: argument in value
    if name == "STRSTARTS":
        return lambda value: value.startswith(argument)
    if name == "STRENDS":
        return lambda value: value.endswith(argument)
    return _pattern(argument)


def _pattern(argument: str) -> Callable[[str], object] | None:
    """Return the search for a pattern that two dialects of regular expressions read alike."""
    if not _PLAIN.fullmatch(argument) or "--" in argument:
        return None
    if sum(map(argument.count, "*+")) > _REPETITIONS:
        return None
    # `$` is the end of the text there; here it is also before a line feed at the end.
    ended = re.sub(r"(\\.|\[[^\]]*\])|\$", lambda part: part[1] or r"\Z", argument)
    try:
        return re.compile(ended).search
    except re.error:
        return None


class Expressions:
    """Evaluates expressions over tables of one dictionary and remembers the values."""

    def __init__(self, dictionary: Dictionary) -> None:
        self._dictionary = dictionary
        self._store = Store()
        self._memo: dict[tuple[str, tuple[str, ...]], _Memo] = {}
        self._true = dictionary.intern(b'"true"^^<http://www.w3.org/2001/XMLSchema#boolean>')

    def holds(
        self, expression: Expression, table: Table, columns: Sequence[tuple[str, str]], clock: Clock
    ) -> NDArray[np.bool_]:
        """Return for each row whether the effective boolean value is true; an error is not."""
        quick = shortcut(expression, table, dict(columns), self._dictionary)
        if quick is not None:
            return quick
        test = text_test(bare(expression.text))
        if test is not None and {test.variable, test.other or test.variable} <= dict(columns).keys():
            return self._texts(test, expression, table, columns, clock)
        return self._truth(expression, table, columns, clock)

    def _truth(
        self, expression: Expression, table: Table, columns: Sequence[tuple[str, str]], clock: Clock
    ) -> NDArray[np.bool_]:
        text = f"IF({expression.text}, true, false)"
        truth: NDArray[np.bool_] = self._values(text, expression, table, columns, clock) == self._true
        return truth

    def _texts(
        self, test: TextTest, expression: Expression, table: Table, columns: Sequence[tuple[str, str]], clock: Clock
    ) -> NDArray[np.bool_]:
        """Decide a test of text by the spellings, and ask the engine where it is left open."""
        decided = self._decided(test, table, dict(columns))
        result: NDArray[np.bool_] = decided == 1
        left = np.flatnonzero(decided == OPEN)
        if left.size:
            result[left] = self._truth(expression, table.take(left), columns, clock)
        return result

    def _decided(self, test: TextTest, table: Table, columns: Mapping[str, str]) -> NDArray[np.int8]:
        """Decide a test of text for each row, once for each term, and for each that it is compared with."""
        values = table.columns[columns[test.variable]]
        if test.other is None:
            different = distinct(values)
            return test.decide(self._dictionary.spellings(different))[np.searchsorted(different, values)]
        others = table.columns[columns[test.other]]
        compared = distinct(others)
        decided = np.full(table.rows, OPEN, np.int8)
        if compared.size * _REPEATED > table.rows:
            return decided
        order = np.argsort(others, kind="stable")
        rows_of = np.split(order, np.searchsorted(others[order], compared[1:]))
        for term, rows in zip(self._dictionary.spellings(compared), rows_of, strict=True):
            against = test.against(term)
            if against is not None:
                decided[rows] = self._decided(against, table.take(rows), columns)
        return decided

    def values(self, expression: Expression, table: Table, columns: Sequence[tuple[str, str]], clock: Clock) -> Keys:
        """Return the value for each row, `ERROR` where there is none."""
        name = bare(expression.text)
        if _VARIABLE.fullmatch(name):
            column = dict(columns).get(name[1:])
            return np.full(table.rows, ERROR, np.int64) if column is None else table.columns[column]
        return self._values(expression.text, expression, table, columns, clock)

    def _values(
        self, text: str, expression: Expression, table: Table, columns: Sequence[tuple[str, str]], clock: Clock
    ) -> Keys:
        seen = {name: table.columns[column] for name, column in columns if name in expression.variables}
        names = tuple(seen)
        arguments = Table(seen, table.rows)
        memo = self._memo.setdefault((text, names), _Memo())
        distinct, places = _distinct(arguments)
        results, missing = memo.look_up(distinct)
        if missing.size:
            values = self._compute(text, names, distinct.take(missing), clock)
            results[missing] = values
            memo.remember(distinct.take(missing), values)
        return results[places]

    def _compute(self, text: str, names: tuple[str, ...], arguments: Table, clock: Clock) -> Keys:
        """Evaluate an expression for each row, whatever was remembered."""
        results = np.full(arguments.rows, ERROR, np.int64)
        blank = np.zeros(arguments.rows, bool)
        for column in arguments.columns.values():
            blank |= self._dictionary.may_have_blanks(column)
        for rows, evaluate in ((np.flatnonzero(~blank), self._batch), (np.flatnonzero(blank), self._with_blanks)):
            for begin in range(0, rows.size, _BATCH):
                clock.check()
                chosen = rows[begin : begin + _BATCH]
                evaluate(text, names, arguments.take(chosen), chosen, results)
        return results

    def _batch(self, text: str, names: tuple[str, ...], arguments: Table, rows: Keys, results: Keys) -> None:
        """Evaluate an expression for rows without blank nodes, by one query."""
        spelt = [
            [spelling or b"UNDEF" for spelling in self._dictionary.spellings(arguments.columns[name])] for name in names
        ]
        shown = " ".join(["?kg_row", *map(_shown, names)])
        numbers = [b"%d" % number for number in range(arguments.rows)]
        lines = b"\n".join(b"(%s)" % b" ".join(row) for row in zip(numbers, *spelt, strict=True))
        query = f"SELECT ?kg_row ?kg_value {{ VALUES ({shown}) {{\n{lines.decode()}\n}} BIND({text} AS ?kg_value) }}"
        self._read(self._store.query(query), rows, results)

    def _with_blanks(self, text: str, names: tuple[str, ...], arguments: Table, rows: Keys, results: Keys) -> None:
        """Evaluate an expression for rows with blank nodes, which cannot be in `VALUES`: they go into a store."""
        store = Store()
        for row in range(arguments.rows):
            subject = NamedNode(f"urn:kg:row:{row}")
            store.add(Quad(subject, NamedNode("urn:kg:row"), Literal(row)))
            for index, name in enumerate(names):
                identifier = int(arguments.columns[name][row])
                if identifier:
                    argument = NamedNode(f"urn:kg:argument:{index}")
                    store.add(Quad(subject, argument, self._dictionary.term(identifier)))
        optional = " ".join(
            f"OPTIONAL {{ ?kg_subject <urn:kg:argument:{index}> {_shown(name)} }}" for index, name in enumerate(names)
        )
        query = f"SELECT ?kg_row ?kg_value {{ ?kg_subject <urn:kg:row> ?kg_row {optional} BIND({text} AS ?kg_value) }}"
        self._read(store.query(query), rows, results)

    def _read(self, solutions: object, rows: Keys, results: Keys) -> None:
        """Put the values of a query's solutions in the places of their rows."""
        values: dict[object, int] = {}
        for solution in cast("QuerySolutions", solutions):
            value = solution["kg_value"]
            if value is not None:
                identifier = values.get(value)
                if identifier is None:
                    identifier = values[value] = self._dictionary.intern_term(value)
                results[rows[int(solution["kg_row"].value)]] = identifier


def _distinct(arguments: Table) -> tuple[Table, Keys]:
    """Return each row once, and for each row of the table its place among them."""
    keys = arguments.packed(list(arguments.columns))
    if keys.size > 1 and (keys[1:] > keys[:-1]).all():
        return arguments, np.arange(keys.size)
    ordered = distinct(keys)
    places = np.searchsorted(ordered, keys)
    first = np.empty(ordered.size, np.int64)
    first[places] = np.arange(keys.size)
    return arguments.take(first), places


def _shown(name: str) -> str:
    """Return how a variable is written in an expression."""
    return spelling(form.Variable(name))


class _Memo:
    """The values of one expression: sorted keys of the arguments with their values; by row where there are many."""

    def __init__(self) -> None:
        self._keys = EMPTY
        self._values = EMPTY
        self._rows: dict[tuple[int, ...], int] = {}

    def look_up(self, arguments: Table) -> tuple[Keys, Keys]:
        """Return the values of distinct arguments, `ERROR` for those not known, and the places of the latter."""
        if len(arguments.columns) > _PACKABLE:
            numbers = [self._rows.get(row, -1) for row in _tuples(arguments)]
            values = np.array(numbers, np.int64)
            return np.maximum(values, ERROR), np.flatnonzero(values < 0)
        keys = arguments.packed(list(arguments.columns))
        cached = among(keys, self._keys)
        values = np.full(keys.size, ERROR, np.int64)
        values[cached] = self._values[np.searchsorted(self._keys, keys[cached])]
        return values, np.flatnonzero(~cached)

    def remember(self, arguments: Table, values: Keys) -> None:
        """Keep the values of distinct arguments that were not known."""
        if len(arguments.columns) > _PACKABLE:
            self._rows.update(zip(_tuples(arguments), values.tolist(), strict=True))
            return
        keys = np.concatenate([self._keys, arguments.packed(list(arguments.columns))])
        order = np.argsort(keys, kind="stable")
        self._keys, self._values = keys[order], np.concatenate([self._values, values])[order]


def _tuples(arguments: Table) -> Iterator[tuple[int, ...]]:
    return zip(*(column.tolist() for column in arguments.columns.values()), strict=True)
