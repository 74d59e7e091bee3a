"""The internal form as text for people: what a rule reads and writes, its head and its body, one element a line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from kg.rules import sparql
from kg.rules.dependencies import reads
from kg.rules.form import Aggregate, Assignment, Atom, Element, EngineBlock, Exists, Filter, Rule, Variable
from kg.rules.printing.rq import shortened
from kg.syntax.lexer import bare
from kg.syntax.names import PREFIXES


def to_form(rules: Sequence[Rule], prefixes: Mapping[str, str] = PREFIXES, strata: Sequence[int] = ()) -> str:
    """Return the rules as text; `strata` are the numbers of those that they run in, where they are known."""
    texts = ("\n".join(_lines(rule, strata)) for rule in rules)
    return shortened("\n\n".join(texts), prefixes)[0]


def _lines(rule: Rule, strata: Sequence[int]) -> Iterator[str]:
    yield f"rule {rule}"
    yield f"  at            {rule.place}"
    if strata:
        yield f"  {'strata ' if len(strata) > 1 else 'stratum'}       {', '.join(map(str, strata))}"
    if rule.order:
        yield f"  order         {rule.order:g}"
    inputs = list(reads(rule))
    without = [read.atom for read in inputs if read.negated]
    yield from _listed("reads", (read.atom for read in inputs if not read.negated))
    yield from _listed("reads negated", without)
    yield from _listed("writes", rule.head)
    yield "  head"
    yield from (f"    {_atom(atom)}" for atom in rule.head)
    yield "  body"
    yield from (f"    {line}" for element in rule.body for line in _element(element).split("\n"))


def _listed(title: str, atoms: Iterable[Atom]) -> Iterator[str]:
    terms = (sparql.term(atom.predicate) for atom in atoms)
    names = sorted({term if term.startswith("<") else "any" for term in terms})
    if names:
        yield f"  {title:<13} {' '.join(names)}"


def _atom(atom: Atom) -> str:
    return sparql.triple(atom) + (" (asserted)" if atom.asserted else "")


def _element(element: Element) -> str:
    """Return an element, its body and text indented below it."""
    if isinstance(element, Atom):
        return _atom(element)
    if isinstance(element, Filter):
        return f"filter {bare(element.expression.text)}"
    if isinstance(element, Assignment):
        note = " (mints)" if element.expression.mints else ""
        return f"{sparql.spelling(element.variable)} := {element.expression.text}{note}"
    if isinstance(element, Exists):
        return _below("not exists" if element.negated else "exists", element.body)
    if isinstance(element, Aggregate):
        columns = []
        for column in element.columns:
            argument = column.expression.text if column.expression else "*"
            distinct = "DISTINCT " if column.distinct else ""
            columns.append(f"{sparql.spelling(column.variable)} := {column.function}({distinct}{argument})")
        keys = f" by {_names(element.keys)}" if element.keys else ""
        return _below(f"group{keys}: {', '.join(columns)}", element.body)
    if isinstance(element, EngineBlock):
        optional = f", maybe {_names(element.optional)}" if element.optional else ""
        reading = "anything" if element.reads is None else " ".join(sorted(map(str, element.reads))) or "nothing"
        monotone = "" if element.monotone else "; not monotone"
        title = f"engine gives {_names(element.variables)}{optional}; reads {reading}{monotone}"
        return f"{title}\n{sparql.indented(element.text)}"
    return sparql.group((element,))


def _below(title: str, body: Iterable[Element]) -> str:
    return "\n".join([title, *(sparql.indented(_element(element)) for element in body)])


def _names(variables: Iterable[Variable]) -> str:
    return " ".join(map(sparql.spelling, variables))
