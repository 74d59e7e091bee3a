"""Parser of expressions, sub-SELECTs, VALUES and groups (SPARQL 1.2, section 19.8, from GroupGraphPattern on).

Expressions are checked and respelt, but not parsed to a tree: the store's engine evaluates their text.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from pyoxigraph import Literal, NamedNode, Triple

from kg.errors import Fix
from kg.similar import similar, suggest
from kg.syntax import tree
from kg.syntax.cursor import MAX_NESTING
from kg.syntax.functions import AGGREGATES, FUNCTIONS, Arguments
from kg.syntax.lexer import Kind, as_operator
from kg.syntax.terms import Term, Variable
from kg.syntax.triples import Mode, Triples

_COMPARISONS: Final = ("=", "!=", "<", ">", "<=", ">=")
_ARITHMETIC: Final = ("+", "-", "*", "/")
_KEYWORDS: Final = ("FILTER", "OPTIONAL", "UNION", "MINUS", "BIND", "VALUES", "GRAPH", "SELECT", "SERVICE", "NOT")


@dataclass(slots=True)
class _Content:
    """The content of an expression read so far."""

    exists: list[tree.Exists] = field(default_factory=list)
    aggregates: list[tree.AggregateCall] = field(default_factory=list)


class Patterns(Triples):
    """Parser of expressions, sub-SELECTs and groups."""

    functions: Mapping[str, Arguments] = FUNCTIONS
    """The built-in functions of the notation."""

    patterns_in_expressions = True
    """Whether the notation has EXISTS."""

    aggregates_allowed = False
    """Whether aggregates are allowed here."""

    def __init__(self, text: str, path: str, *, prefixes: Mapping[str, str], base: str | None = None) -> None:
        super().__init__(text, path, prefixes=prefixes, base=base)
        self._open: list[_Content] = []
        self.calls: list[tree.Call] = []

    def expression(self) -> tree.Expression:
        """Parse an expression."""
        start, first = self.token.start, len(self.consumed)
        self._open.append(_Content())
        self._operations()
        return self._closed(start, first)

    def constraint(self) -> tree.Expression:
        """Parse the argument of FILTER or HAVING: an expression in brackets or a function call."""
        start, first = self.token.start, len(self.consumed)
        self._open.append(_Content())
        if self.at("("):
            self._bracketed_expression()
        elif self.token.kind is Kind.WORD:
            self._called_word("`(` or a function")
        else:
            start = self.token.start
            self._custom(self.iri("`(` or a function").value, start)
        return self._closed(start, first)

    def _closed(self, start: int, first: int) -> tree.Expression:
        content = self._open.pop()
        tokens = self.consumed[first:]
        grouped = [call.span for call in content.aggregates]
        names = dict.fromkeys(
            token.text[1:]
            for token in tokens
            if token.kind is Kind.VARIABLE and not any(span.start < token.start < span.end for span in grouped)
        )
        return tree.Expression(
            self.spelling(tokens),
            tuple(names),
            self.span(start),
            tuple(content.exists),
            tuple(content.aggregates),
        )

    def _operations(self) -> None:
        """Parse operands and operators; their precedence is left to the engine."""
        compared = False
        self._operand()
        while True:
            self.token = as_operator(self.token)
            if self.at("&&", "||"):
                compared = False
            elif self.at(*_COMPARISONS) or self.at_word("IN", "NOT"):
                if compared:
                    raise self.error("comparisons do not chain", self.token.start, hint="Join two with `&&`.")
                compared = True
                if self.token.kind is Kind.WORD:
                    self.accept_word("NOT")
                    self.expect_word("IN")
                    self._arguments()
                    continue
            elif not self.at(*_ARITHMETIC):
                return
            self.advance()
            self._operand()

    def _operand(self) -> None:
        """Parse an operand with its prefix operators: any number of `!`, or one `-` or `+`."""
        signs = 0
        while self.accept("!"):
            signs += 1
            if signs > MAX_NESTING:
                raise self.error(f"the rule nests deeper than {MAX_NESTING}", self.token.start, code="KG209")
        if not self.at_signed():
            self.accept("-", "+")
        self._primary_expression()

    def _primary_expression(self) -> None:
        with self.nested():
            if self.at("("):
                self._bracketed_expression()
            elif self.at("<<("):
                self.triple_term(Mode.PATTERN)
            elif self.at_iri():
                start = self.token.start
                name = self.iri()
                if self.at("("):
                    self._custom(name.value, start)
            elif self.token.kind is Kind.VARIABLE:
                self.advance()
            elif self.at_literal():
                self.literal()
            else:
                self._called_word("an expression")

    def _bracketed_expression(self) -> None:
        self.expect("(")
        self._operations()
        self.expect(")", " or an operator")

    def _called_word(self, what: str) -> None:
        """Parse a call of a built-in function or aggregate, or EXISTS."""
        name = self.token.text.upper()
        if self.token.kind is not Kind.WORD:
            raise self.expected(what)
        if name in {"NOT", "EXISTS"} and self.patterns_in_expressions:
            self._existence()
        elif name in AGGREGATES and self.aggregates_allowed:
            self._aggregate(name)
        elif name in self.functions:
            self._built_in(name)
        else:
            raise self._unknown_function(what)

    def _unknown_function(self, what: str) -> Exception:
        name = self.token.text
        if name.upper() in AGGREGATES and self.patterns_in_expressions:
            hint = "Aggregates are allowed in the columns and the HAVING clause of a SELECT."
            return self.error(f"the aggregate {name.upper()} is not allowed here", self.token.start, hint=hint)
        if name.upper() in FUNCTIONS or name.upper() in {"EXISTS", *AGGREGATES}:
            return self.error(f"SPARQL RL has no {name.upper()}", self.token.start)
        if self.text[self.token.end :].lstrip().startswith("("):
            near = similar(name.upper(), self.functions)
            return self.error(f"unknown function `{name}`", self.token.start, hint=suggest(near), fixes=map(Fix, near))
        return self.expected(what, self.functions)

    def _built_in(self, name: str) -> None:
        token = self.advance()
        if name == "BOUND" and self.at("("):
            self.advance()
            self.variable()
            self.expect(")")
            return
        count = self._arguments()
        fewest, most = self.functions[name]
        if count < fewest or (most is not None and count > most):
            takes = f"{fewest}" if most == fewest else f"{fewest} to {most}"
            raise self.error(f"{name} takes {takes} argument{'' if takes == '1' else 's'}, not {count}", token.start)
        self.calls.append(tree.Call(name, count, tree.Span(token.start, token.end)))

    def _custom(self, name: str, start: int) -> None:
        """Parse the arguments of a function called by its IRI, which begins at `start`."""
        span = self.span(start)
        self.calls.append(tree.Call(name, self._arguments(), span))

    def _arguments(self) -> int:
        """Parse arguments in brackets and return their number."""
        self.expect("(")
        if self.accept(")"):
            return 0
        count = 1
        self._operations()
        while self.accept(","):
            self._operations()
            count += 1
        self.expect(")", " or `,`")
        return count

    def _existence(self) -> None:
        start = self.token.start
        negated = self.accept_word("NOT")
        self.expect_word("EXISTS")
        group = self.group()
        self._open[-1].exists.append(tree.Exists(group, negated, asserted=False, span=self.span(start)))

    def _aggregate(self, name: str) -> None:
        start, first = self.token.start, len(self.consumed)
        self.advance()
        self.expect("(")
        distinct = self.accept_word("DISTINCT")
        self.aggregates_allowed = False
        argument = None if name == "COUNT" and self.accept("*") else self.expression()
        self.aggregates_allowed = True
        separator = " "
        if name == "GROUP_CONCAT" and self.accept(";"):
            self.expect_word("SEPARATOR")
            self.expect("=")
            separator = self.string()
        self.expect(")")
        text = self.spelling(self.consumed[first:])
        call = tree.AggregateCall(name, argument, distinct, separator, self.span(start), text)
        self._open[-1].aggregates.append(call)

    def sub_select(self) -> tree.SubSelect:
        """Parse a sub-SELECT without its braces."""
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
        self._check_columns(columns, keys, tree.visible(group.nodes), grouped=grouped, start=start)
        group = self._with_values(group, keys, grouped=grouped)
        projections = tuple(column for column, _ in columns)
        text = self.spelling(self.consumed[first:])
        return tree.SubSelect(projections, distinct, group, keys, having, sliced, self.span(start), text)

    def _columns(self) -> list[tuple[tree.Projection, int]]:
        """Parse columns, each with its offset; an empty list for `*`."""
        columns: list[tuple[tree.Projection, int]] = []
        if self.accept("*"):
            return columns
        while True:
            start = self.token.start
            if self.token.kind is Kind.VARIABLE:
                columns.append((tree.Projection(self.variable(), None), start))
            elif self.accept("("):
                self.aggregates_allowed = True
                expression = self.expression()
                self.aggregates_allowed = False
                self.expect_word("AS")
                columns.append((tree.Projection(self.variable(), expression), start))
                self.expect(")")
            elif columns:
                return columns
            else:
                raise self.expected("a variable, `(` or `*`")

    def _check_columns(
        self,
        columns: list[tuple[tree.Projection, int]],
        keys: tuple[tree.Projection, ...],
        inner: set[str],
        *,
        grouped: bool,
        start: int,
    ) -> None:
        """Refuse columns that assign to a bound variable, or are neither grouped nor aggregated."""
        key_names = {key.variable.name for key in keys}
        seen: set[str] = set()
        if grouped and not columns:
            raise self.error("`SELECT *` conflicts with GROUP BY", start, hint="Name the columns.")
        for column, offset in columns:
            name, expression = column.variable.name, column.expression
            if expression and name in inner:
                raise self.error(f"SELECT assigns to `?{name}`, which is bound before it", offset)
            for used in (expression.variables if expression else (name,)) if grouped else ():
                if used not in key_names and not (expression and expression.exists):
                    hint = "Group by it, or aggregate it, as in SAMPLE."
                    raise self.error(f"`?{used}` is not a GROUP BY key and not aggregated", offset, hint=hint)
            if name in seen:
                raise self.error(f"SELECT has `?{name}` twice", offset)
            seen.add(name)

    def _with_values(self, group: tree.Group, keys: tuple[tree.Projection, ...], *, grouped: bool) -> tree.Group:
        """Move VALUES after a sub-SELECT into its group, if that is equivalent."""
        if not self.at_word("VALUES"):
            return group
        start = self.advance().start
        variables, rows = self.table()
        exact = len(set(rows)) == len(rows) and all(None not in row for row in rows)
        if grouped and not (exact and set(variables) <= {key.variable for key in keys if key.expression is None}):
            hint = "Put it before the sub-SELECT or into its braces."
            message = "VALUES after a grouped sub-SELECT is not allowed in rules"
            raise self.error(message, start, code="KG209", hint=hint)
        spelt = self.spelling([token for token in self.consumed if token.start >= start])
        text = f"{group.text[:-1]}{spelt} }}" if group.text else ""
        return tree.Group((*group.nodes, tree.ValuesBlock(variables, rows, self.span(start))), group.span, text)

    def modifiers(self) -> tuple[tuple[tree.Projection, ...], tuple[tree.Expression, ...], bool]:
        """Parse solution modifiers: GROUP BY, HAVING, ORDER BY, LIMIT and OFFSET."""
        keys: list[tree.Projection] = []
        having: list[tree.Expression] = []
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

    def _key(self) -> tree.Projection:
        if self.token.kind is Kind.VARIABLE:
            return tree.Projection(self.variable(), None)
        if not self.at("("):
            return tree.Projection(Variable(f".{self.fresh()}"), self.constraint())
        self.advance()
        expression = self.expression()
        variable = self.variable() if self.accept_word("AS") else Variable(f".{self.fresh()}")
        self.expect(")", " or `AS`")
        return tree.Projection(variable, expression)

    def _order(self) -> None:
        """Parse ORDER BY, which has no effect without LIMIT."""
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
        """Parse variables and rows of terms of VALUES."""
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
                raise self.error(f"`{self.token.text}` is listed twice", self.token.start)
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
        term = self.any_term(Mode.DATA, "a term or UNDEF")
        if not isinstance(term, NamedNode | Literal | Triple):
            raise self.error("a triple term in VALUES must not contain blank nodes or a literal subject", start)
        return term

    def group(self) -> tree.Group:
        """Parse a group or a sub-SELECT in braces."""
        outer, aggregates_allowed, first = self.block, self.aggregates_allowed, len(self.consumed)
        start = self.expect("{").start
        self.aggregates_allowed = False
        with self.nested():
            self.new_block()
            nodes: list[tree.Node] = [self.sub_select()] if self.at_word("SELECT") else self._nodes()
            self.expect("}", " or a pattern")
        self.block, self.aggregates_allowed = outer, aggregates_allowed
        return tree.Group(tuple(nodes), self.span(start), self.spelling(self.consumed[first:]))

    def _nodes(self) -> list[tree.Node]:
        nodes: list[tree.Node] = []
        while True:
            nodes += self.triples(Mode.PATTERN)
            if self.at("}") or self.at_end():
                return nodes
            if self.at_subject():
                raise self.expected("`.` or `}`")
            nodes.append(self._node_at(nodes))
            if not isinstance(nodes[-1], tree.Filter | tree.Exists):
                self.new_block()
            self.accept(".")

    def _node_at(self, before: list[tree.Node]) -> tree.Node:
        if self.at("{"):
            return self._union()
        readers: dict[str, Callable[[], tree.Node]] = {
            "FILTER": self._filter,
            "OPTIONAL": lambda: self._braced(tree.Optional),
            "MINUS": lambda: self._braced(tree.Minus),
            "VALUES": self._values,
            "GRAPH": self._graph,
        }
        word = self.token.text.upper() if self.token.kind is Kind.WORD else ""
        if word == "BIND":
            return self._bind(before)
        if word == "SERVICE":
            hint = "Rules read the store alone; load what the other server has first."
            raise self.error("SERVICE is not allowed in rules", self.token.start, code="KG209", hint=hint)
        if word not in readers:
            raise self.expected("a pattern or `}`", _KEYWORDS)
        return readers[word]()

    def _filter(self) -> tree.Node:
        start = self.advance().start
        first = len(self.consumed)
        expression, span = self.constraint(), self.span(start)
        spans = [exists.span for exists in expression.exists]
        tokens = (token for token in self.consumed[first:] if not any(s.start <= token.start < s.end for s in spans))
        outside = [token.text for token in tokens]
        if len(spans) != 1 or not set(outside) <= {"(", ")", "!"}:
            return tree.Filter(expression, span)
        # The filter is EXISTS and nothing else.
        (only,) = expression.exists
        return tree.Exists(only.group, only.negated ^ (outside.count("!") % 2 == 1), asserted=False, span=span)

    def _braced(self, kind: type[tree.Optional | tree.Minus]) -> tree.Node:
        start = self.advance().start
        return kind(self.group(), self.span(start))

    def _values(self) -> tree.Node:
        start = self.advance().start
        variables, rows = self.table()
        return tree.ValuesBlock(variables, rows, self.span(start))

    def _graph(self) -> tree.Node:
        start = self.advance().start
        name = self.variable() if self.token.kind is Kind.VARIABLE else self.iri("a variable or the IRI of a graph")
        return tree.GraphBlock(name, self.group(), self.span(start))

    def _bind(self, before: list[tree.Node]) -> tree.Node:
        start = self.advance().start
        self.expect("(")
        expression = self.expression()
        self.expect_word("AS")
        if self.token.kind is Kind.VARIABLE and self.token.text[1:] in tree.visible(before):
            raise self.error(f"BIND assigns to `{self.token.text}`, which is bound before it", self.token.start)
        variable = self.variable()
        self.expect(")")
        return tree.Bind(variable, expression, self.span(start))

    def _union(self) -> tree.Node:
        start = self.token.start
        groups = [self.group()]
        while self.accept_word("UNION"):
            groups.append(self.group())
        only = groups[0].nodes
        if len(groups) == len(only) == 1 and isinstance(only[0], tree.SubSelect):
            return only[0]
        return tree.Union(tuple(groups), self.span(start))
