"""Sub-SELECT and tables of values (SPARQL 1.1, section 19.8, productions SubSelect and DataBlock)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import Literal, NamedNode, Triple

from kg.rules.form import Variable
from kg.rules.syntax.expressions import Expressions
from kg.rules.syntax.lexer import Kind
from kg.rules.syntax.scope import visible
from kg.rules.syntax.terms import Mode
from kg.rules.syntax.tree import Group, Projection, SubSelect, ValuesBlock

if TYPE_CHECKING:
    from kg.rules.form import Term
    from kg.rules.syntax.tree import Expression

__all__ = ["Selects"]


class Selects(Expressions):
    """Reads sub-SELECTs."""

    def sub_select(self) -> SubSelect:
        """Read a sub-SELECT without its braces."""
        first = len(self.consumed)
        start = self.expect_word("SELECT").start
        distinct = self.accept_word("DISTINCT")
        if not distinct:
            self.accept_word("REDUCED")
        columns = self._columns()
        self.accept_word("WHERE")
        group = self.group()
        keys, having, sliced = self.modifiers()
        grouped = bool(
            keys or having or any(column.expression and column.expression.aggregates for column, _ in columns)
        )
        self._check_columns(columns, keys, visible(group.nodes), grouped=grouped, start=start)
        group = self._with_values(group, keys, grouped=grouped)
        projections = tuple(column for column, _ in columns)
        text = self.spelling(self.consumed[first:])
        return SubSelect(projections, distinct, group, keys, having, sliced, self.span(start), text)

    def _columns(self) -> list[tuple[Projection, int]]:
        """Read columns, each with its offset; none is `*`."""
        columns: list[tuple[Projection, int]] = []
        if self.accept("*"):
            return columns
        while True:
            start = self.token.start
            if self.token.kind is Kind.VARIABLE:
                columns.append((Projection(self.variable(), None), start))
            elif self.accept("("):
                self.aggregates_allowed = True
                expression = self.expression()
                self.aggregates_allowed = False
                self.expect_word("AS")
                columns.append((Projection(self.variable(), expression), start))
                self.expect(")")
            elif columns:
                return columns
            else:
                raise self.expected("a variable, `(` or `*`")

    def _check_columns(
        self,
        columns: list[tuple[Projection, int]],
        keys: tuple[Projection, ...],
        inner: set[str],
        *,
        grouped: bool,
        start: int,
    ) -> None:
        """Refuse columns that assign to a bound variable, and those that are neither grouped nor aggregated."""
        known = {key.variable.name for key in keys}
        seen: set[str] = set()
        if grouped and not columns:
            raise self.error("`SELECT *` cannot stand with GROUP BY", start, hint="Name the columns.")
        for column, offset in columns:
            name, expression = column.variable.name, column.expression
            if expression and name in inner:
                raise self.error(f"SELECT assigns to `?{name}`, which is bound before it", offset)
            for used in (expression.variables if expression else (name,)) if grouped else ():
                if used not in known and not (expression and expression.exists):
                    hint = "Group by it, or aggregate it, as in SAMPLE."
                    raise self.error(f"`?{used}` is neither a key of GROUP BY nor aggregated", offset, hint=hint)
            if name in seen:
                raise self.error(f"SELECT has `?{name}` twice", offset)
            seen.add(name)

    def _with_values(self, group: Group, keys: tuple[Projection, ...], *, grouped: bool) -> Group:
        """Read VALUES behind a sub-SELECT into its group, where that means the same."""
        if not self.at_word("VALUES"):
            return group
        start = self.advance().start
        variables, rows = self.table()
        exact = len(set(rows)) == len(rows) and all(None not in row for row in rows)
        if grouped and not (exact and set(variables) <= {key.variable for key in keys if key.expression is None}):
            hint = "Put it before the sub-SELECT or into its braces."
            message = "VALUES behind a grouped sub-SELECT is not allowed in rules"
            raise self.error(message, start, code="KG209", hint=hint)
        text = group.text[:-1] + self._spelt_since(start) + " }" if group.text else ""
        return Group((*group.nodes, ValuesBlock(variables, rows, self.span(start))), group.span, text)

    def _spelt_since(self, start: int) -> str:
        return self.spelling([token for token in self.consumed if token.start >= start])

    def modifiers(self) -> tuple[tuple[Projection, ...], tuple[Expression, ...], bool]:
        """Read what may stand behind WHERE: the keys of groups, HAVING, and whether only some rows are wanted."""
        keys: list[Projection] = []
        having: list[Expression] = []
        if self.accept_word("GROUP"):
            self.expect_word("BY")
            keys.append(self._key())
            while self._at_condition():
                keys.append(self._key())
        self.aggregates_allowed = True
        if self.accept_word("HAVING"):
            having.append(self.constraint())
            while self._at_condition() and self.token.kind is not Kind.VARIABLE:
                having.append(self.constraint())
        self._order()
        self.aggregates_allowed = False
        return tuple(keys), tuple(having), self._slice()

    def _at_condition(self) -> bool:
        if self.at("(") or self.at_iri() or self.token.kind is Kind.VARIABLE:
            return True
        return self.token.kind is Kind.WORD and not self.at_word("HAVING", "ORDER", "LIMIT", "OFFSET", "VALUES")

    def _key(self) -> Projection:
        if self.token.kind is Kind.VARIABLE:
            return Projection(self.variable(), None)
        if not self.at("("):
            return Projection(Variable(f".{self.fresh()}"), self.constraint())
        self.advance()
        expression = self.expression()
        variable = self.variable() if self.accept_word("AS") else Variable(f".{self.fresh()}")
        self.expect(")", " or `AS`")
        return Projection(variable, expression)

    def _order(self) -> None:
        """Read ORDER BY, which without LIMIT says nothing."""
        if not self.accept_word("ORDER"):
            return
        self.expect_word("BY")
        self._order_condition()
        while self._at_condition():
            self._order_condition()

    def _order_condition(self) -> None:
        if self.accept_word("ASC", "DESC") and not self.at("("):
            raise self.expected("`(`")
        if self.token.kind is Kind.VARIABLE:
            self.advance()
        else:
            self.constraint()

    def _slice(self) -> bool:
        seen: set[str] = set()
        while self.at_word("LIMIT", "OFFSET") and self.token.text.upper() not in seen:
            seen.add(self.advance().text.upper())
            if self.token.kind is not Kind.NUMBER or not self.token.text.isdecimal():
                raise self.expected("a whole number")
            self.advance()
        return bool(seen)

    def table(self) -> tuple[tuple[Variable, ...], tuple[tuple[Term | None, ...], ...]]:
        """Read variables and rows of terms behind VALUES."""
        single = self.token.kind is Kind.VARIABLE
        variables = (self.variable(),) if single else self._headings()
        rows: list[tuple[Term | None, ...]] = []
        self.expect("{")
        while not self.accept("}"):
            rows.append((self._cell(),) if single else self._row(len(variables)))
        return variables, tuple(rows)

    def _headings(self) -> tuple[Variable, ...]:
        self.expect("(", " or a variable")
        variables: list[Variable] = []
        while not self.accept(")"):
            if self.token.text[1:] in {variable.name for variable in variables}:
                raise self.error(f"`{self.token.text}` stands twice", self.token.start)
            variables.append(self.variable())
        return tuple(variables)

    def _row(self, width: int) -> tuple[Term | None, ...]:
        start = self.expect("(", " or `}`").start
        cells: list[Term | None] = []
        while not self.accept(")"):
            cells.append(self._cell())
        if len(cells) != width:
            raise self.error(f"a row of {len(cells)} for {width} variables", start)
        return tuple(cells)

    def _cell(self) -> Term | None:
        if self.accept_word("UNDEF"):
            return None
        if self.at_label() or self.at("["):
            raise self.error("a blank node in VALUES", self.token.start, hint="VALUES takes IRIs, literals and UNDEF.")
        start = self.token.start
        term = self.triple_term(Mode.DATA) if self.at("<<(") else self.simple_term(Mode.DATA, "a term or UNDEF")
        if not isinstance(term, NamedNode | Literal | Triple):
            raise self.error("a triple term in VALUES has neither blank nodes nor a literal as subject", start)
        return term
