"""The internal form as SPARQL text, for explanation, remote servers and people.

The order of a body is kept. A group of SPARQL differs from a body in three ways, and all are mended here: its filters
see all of the group, also what is behind them; BIND may not name a bound variable; and BIND keeps the solutions in
which its expression is in error.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from pyoxigraph import NamedNode, Triple

from kg.errors import RuleError
from kg.rules import form
from kg.syntax.names import shorten
from kg.syntax.terms import GENERATED

_IRI: Final = re.compile(r"<([^<>\s]+)>")
_NEVER_FAILS: Final = re.compile(r"""\?[\w·]+|<[^<>\s]*>|-?[0-9]+(\.[0-9]+)?|"[^"\\]*\"""")
"""Expressions that have a value in every solution, as far as it shows at once: variables and terms."""


@dataclass(frozen=True, slots=True)
class Placed(form.Atom):
    """An atom that is read from one graph, whatever the others hold; evaluation on servers puts it into bodies."""

    graph: NamedNode = field(kw_only=True)


def spelling(variable: form.Variable) -> str:
    """Return how a variable is written in SPARQL, with `?`; different for different variables."""
    name = variable.name
    if name.startswith("."):
        name = GENERATED + "".join(sign if sign == "_" or sign.isalnum() else f"·{ord(sign):x}·" for sign in name[1:])
    elif name.startswith(GENERATED):
        name = f"{GENERATED}·{name}"
    return f"?{name}"


def term(pattern: form.Pattern) -> str:
    """Return a term or a variable as SPARQL writes it, names in brackets."""
    if isinstance(pattern, form.Variable):
        return spelling(pattern)
    if isinstance(pattern, form.TripleTerm | Triple):
        return f"<<( {term(pattern.subject)} {term(pattern.predicate)} {term(pattern.object)} )>>"
    return str(pattern)


def group(body: Sequence[form.Element], *, inferred: NamedNode | None = None) -> str:
    """Return what is between the braces of a group that has the solutions of a body; one element a line.

    `inferred` is the graph with all inferred triples and no asserted ones, against which atoms that match asserted
    triples only are written; without it they match inferred ones too. RuleError KG209 for an atom with a blank node,
    which SPARQL takes for a variable.
    """
    return _Writer(inferred, {}).group(body)


def brief(element: form.Element, prefixes: Mapping[str, str]) -> str:
    """Return a part of a body on one line, its IRIs with these prefixes; RuleError KG209 as `group`."""
    return _IRI.sub(lambda match: shorten(match[1], prefixes), " ".join(group((element,)).split()))


def select(
    body: Sequence[form.Element],
    variables: Sequence[form.Variable],
    bindings: Mapping[form.Variable, form.Term] | None = None,
    *,
    inferred: NamedNode | None = None,
) -> str:
    """Return the query for the distinct solutions of a body that agree with `bindings`, cut to `variables`.

    Bindings to blank nodes cannot be written: the caller gives `substitutions(bindings)` to the store's engine with
    the query, and those variables must be among `variables`. Without variables it asks for one row without columns.
    """
    fixed = {variable: value for variable, value in (bindings or {}).items() if not form.has_blank(value)}
    text = _Writer(inferred, fixed).group(body, used=frozenset(variables))
    if not variables:
        return f"SELECT (1 AS ?{GENERATED}one) WHERE {{\n{text}\n}} LIMIT 1"
    return f"SELECT DISTINCT {' '.join(map(spelling, variables))} WHERE {{\n{text}\n}}"


def substitutions(bindings: Mapping[form.Variable, form.Term]) -> dict[str, form.Term]:
    """Return the bindings that `select` leaves out, by the names that it gives to the variables, without `?`."""
    return {spelling(variable)[1:]: value for variable, value in bindings.items() if form.has_blank(value)}


def construct(rule: form.Rule, *, inferred: NamedNode | None = None) -> str:
    """Return the CONSTRUCT query that gives what a rule derives in one application.

    Each distinct solution of the body gives its triples once, which matters where the head has blank nodes.
    """
    head = " .\n".join(triple(atom) for atom in rule.head)
    text = indented(group(rule.body, inferred=inferred))
    if rule.creates_nodes:
        text = indented(f"{{\n  {distinct_solutions(rule)} {{\n{indented(text)}\n  }}\n}}")
    return f"CONSTRUCT {{\n{indented(head)}\n}}\nWHERE {{\n{text}\n}}"


def distinct_solutions(rule: form.Rule) -> str:
    """Return the beginning of a sub-SELECT that has each solution of a body once, up to its group."""
    names = " ".join(sorted(map(spelling, form.bound_in(rule.body)))) or "*"
    return f"SELECT DISTINCT {names} WHERE"


def triple(atom: form.Atom) -> str:
    """Return a triple of a head or a body, without the full stop."""
    return " ".join(map(term, atom.positions))


def indented(text: str) -> str:
    """Return text one step to the right."""
    return "\n".join(f"  {line}" if line else line for line in text.split("\n"))


def _braces(text: str) -> str:
    return f"{{\n{indented(text)}\n}}"


class _Writer:
    """Writes one body with some variables replaced by terms, all of which SPARQL can write."""

    def __init__(self, inferred: NamedNode | None, fixed: Mapping[form.Variable, form.Term]) -> None:
        self._inferred = inferred
        self._fixed = fixed

    def group(self, body: Sequence[form.Element], used: frozenset[form.Variable] = frozenset()) -> str:
        """Write a body; `used`: the variables that must have their values outside of it."""
        lines: list[str] = list(self._fixed_values(body, used))
        before: frozenset[form.Variable] = frozenset()
        for index, element in enumerate(body):
            late = form.bound_in(body[index + 1 :]) - before
            lines.append(self._element(element, late))
            if self._unseen(element) & late:
                # A SPARQL filter would see variables bound after it: the braces end the group that it sees.
                lines = [_braces("\n".join(lines))]
            before |= form.binds(element)
        return "\n".join(lines)

    def _unseen(self, element: form.Element) -> frozenset[form.Variable]:
        """Return the variables that change the meaning of a filter if they are bound after it."""
        if isinstance(element, form.Assignment):
            return frozenset((element.variable,))
        return form.mentions(element) if isinstance(element, form.Filter | form.Exists) else frozenset()

    def _fixed_values(self, body: Sequence[form.Element], used: frozenset[form.Variable]) -> Iterator[str]:
        """Bind, before all else, the fixed variables that stay as they are in this group or are used outside."""
        needed = used.union(
            *(form.mentions(element) for element in body if not isinstance(element, form.Atom | form.Exists))
        )
        for variable in sorted(needed & self._fixed.keys(), key=str):
            yield f"VALUES {spelling(variable)} {{ {term(self._fixed[variable])} }}"

    def _element(self, element: form.Element, late: frozenset[form.Variable]) -> str:
        """Write an element; `late` are the variables that only elements behind it bind."""
        if isinstance(element, form.Atom):
            return self._atom(element)
        if isinstance(element, form.Filter):
            return f"FILTER({element.expression.text})"
        if isinstance(element, form.Assignment):
            return self._assignment(element)
        if isinstance(element, form.Exists):
            seen = {variable: value for variable, value in self._fixed.items() if variable not in late}
            inner = _Writer(self._inferred, seen).group(element.body)
            return f"FILTER {'NOT ' if element.negated else ''}EXISTS {_braces(inner)}"
        if isinstance(element, form.Values):
            names = " ".join(map(spelling, element.variables))
            rows = "".join(f"\n  ({' '.join(map(term, row))})" for row in element.rows)
            return f"VALUES ({names}) {{{rows}\n}}"
        if isinstance(element, form.EngineBlock):
            return _braces(element.text.strip("\n"))
        return self._aggregate(element)

    def _atom(self, atom: form.Atom) -> str:
        if any(map(form.has_blank, atom.positions)):
            message = f"`{triple(atom)}` has a blank node of the data, which SPARQL cannot write"
            raise RuleError("KG209", message, place=atom.place, hint="Give the node a name, or write a variable.")
        text = f"{triple(atom.replaced(self._fixed))} ."
        if isinstance(atom, Placed):
            return f"GRAPH {atom.graph} {{ {text} }}"
        if atom.asserted and self._inferred is not None:
            return f"{text} FILTER NOT EXISTS {{ GRAPH {self._inferred} {{ {text} }} }}"
        return text

    def _assignment(self, element: form.Assignment) -> str:
        """Write BIND, or where the variable has its value already a comparison with it.

        BIND in error leaves the variable unbound, an assignment in error takes the solution away.
        """
        value = self._fixed.get(element.variable)
        if value is None:
            text = f"BIND({element.expression.text} AS {spelling(element.variable)})"
            certain = _NEVER_FAILS.fullmatch(element.expression.text)
            return text if certain else f"{text}\nFILTER(BOUND({spelling(element.variable)}))"
        return f"FILTER(sameTerm({element.expression.text}, {term(value)}))"

    def _aggregate(self, element: form.Aggregate) -> str:
        """Write a sub-SELECT; only its keys have the values of the group around it."""
        keys = frozenset(element.keys)
        inner = _Writer(self._inferred, {key: value for key, value in self._fixed.items() if key in keys})
        columns = " ".join([*map(spelling, element.keys), *map(_column, element.columns)])
        grouped = f" GROUP BY {' '.join(map(spelling, element.keys))}" if keys else ""
        return _braces(f"SELECT {columns} WHERE {_braces(inner.group(element.body, used=keys))}{grouped}")


def _column(column: form.Column) -> str:
    argument = ("DISTINCT " if column.distinct else "") + (column.expression.text if column.expression else "*")
    if column.function == "GROUP_CONCAT" and column.separator != " ":
        separator = column.separator.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        argument += f'; SEPARATOR = "{separator}"'
    return f"({column.function}({argument}) AS {spelling(column.variable)})"
