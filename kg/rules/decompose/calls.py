"""Functions in rules: those that rules cannot call, and BNODE, which stands for a blank node of the head.

The same data must give the same inferences: a run after a change equals a run from scratch, and a second run changes
nothing. No function whose value differs from call to call allows that. A blank node of the head does: it is named by
its solution. So BNODE is such a node where the rule has one value of it for each solution of its body.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode

from kg.errors import Place, RuleError
from kg.rules.decompose.expressions import new_node
from kg.rules.decompose.renaming import uses
from kg.similar import similar, suggest
from kg.syntax import tree
from kg.syntax.names import PREFIXES, shorten
from kg.syntax.terms import Pattern, TripleTerm, Variable, replaced

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Placing = Callable[[tree.Span], Place]

_NAMES: Final = (
    'Name it after the solution, such as IRI(CONCAT("urn:x:", ENCODE_FOR_URI(STR(?x)))), or write a blank node into '
    "the head."
)
_UNSTABLE: Final = {
    "NOW": "Assert the time as a triple, and compare with its value.",
    "RAND": "Read the number from the data.",
    "STRUUID": _NAMES,
    "UUID": _NAMES,
}
"""Functions whose values differ from call to call, with what to write instead."""

_XSD: Final = PREFIXES["xsd"]
_CASTS: Final = frozenset(
    _XSD + name
    for name in (
        *("boolean", "date", "dateTime", "dayTimeDuration", "decimal", "double", "duration", "float", "gDay"),
        *("gMonth", "gMonthDay", "gYear", "gYearMonth", "integer", "string", "time", "yearMonthDuration"),
    )
)
"""The functions that the store's engine has beside those of SPARQL, each with one argument."""


_BNODE: Final = "BNODE"
_BINDS_NOTHING: Final = tree.Filter | tree.Exists | tree.Minus | tree.Bind
"""What may follow BNODE: with these, a solution of the body has one node."""


def prepared(rule: tree.RuleText, place: Placing) -> tree.RuleText:
    """Return a rule as it is decomposed: with nodes of the head in the place of variables that are assigned BNODE().

    `BNODE("name")` is one node for all assignments of that name. Raises RuleError: KG209 at the first call of a
    function that rules cannot call, and at another use of BNODE; KG201 for a cast of several values.
    """
    for call in rule.calls:
        if call.name in _UNSTABLE:
            message = f"{call.name} is not allowed in rules: its value differs from call to call"
            raise RuleError("KG209", message, place=place(call.span), hint=_UNSTABLE[call.name])
        if ":" in call.name:
            _check_custom(call, place)
    created = [call for call in rule.calls if call.name == _BNODE]
    return _with_new_nodes(rule, created, place) if created else rule


def _check_custom(call: tree.Call, place: Placing) -> None:
    name = shorten(call.name)
    if call.name not in _CASTS:
        near = similar(name, map(shorten, _CASTS)) if call.name.startswith(_XSD) else []
        hint = suggest(near) or "Call a function of SPARQL, or a cast such as xsd:integer."
        raise RuleError("KG209", f"the function {name} does not exist", place=place(call.span), hint=hint)
    if call.arguments != 1:
        message = f"{name} takes 1 argument, not {call.arguments}"
        raise RuleError("KG201", message, place=place(call.span), hint="Cast one value at a time.")


def _with_new_nodes(rule: tree.RuleText, calls: list[tree.Call], place: Placing) -> tree.RuleText:
    """Return a rule without its assignments of BNODE, all of which are in `calls`."""
    nodes = rule.group.nodes
    taken = {label for triple in rule.template for end in (triple.subject, triple.object) for label in _labels(end)}
    created: dict[Variable, Pattern] = {}
    remaining: list[tree.Node] = []
    named: dict[str, BlankNode] = {}
    left, text = list(calls), rule.group.text
    for index, node in enumerate(nodes):
        argument = new_node(node.expression.text) if isinstance(node, tree.Bind) else None
        if argument is None or not isinstance(node, tree.Bind):
            remaining.append(node)
        elif all(isinstance(other, _BINDS_NOTHING) for other in nodes[index:]):
            name = node.variable.name
            label = next(each for each in (f"{name}{number or ''}" for number in count()) if each not in taken)
            created[node.variable] = named.setdefault(argument or label, BlankNode(label))
            taken.add(label)
            text = text.replace(f"BIND({node.expression.text} AS ?{name})", "", 1)
            left = [call for call in left if not node.span.start <= call.span.start < node.span.end]
    names = {variable.name for variable in created}
    wrong = [call.span for call in left]
    wrong += [node.span for node in remaining if not names.isdisjoint(uses([node]))]
    wrong += [triple.span for triple in rule.template if triple.predicate in created]
    if wrong:
        message = "BNODE() must be the value of a variable that only the head has, behind all patterns"
        hint = "Write a blank node into the head, such as `_:new`, or name the node with IRI()."
        raise RuleError("KG209", message, place=place(wrong[0]), hint=hint)
    template = tuple(
        replace(triple, subject=replaced(triple.subject, created), object=replaced(triple.object, created))
        for triple in rule.template
    )
    return replace(rule, template=template, group=replace(rule.group, nodes=tuple(remaining), text=text))


def _labels(pattern: Pattern) -> Iterator[str]:
    if isinstance(pattern, BlankNode):
        yield pattern.value
    elif isinstance(pattern, TripleTerm):
        for part in pattern:
            yield from _labels(part)
