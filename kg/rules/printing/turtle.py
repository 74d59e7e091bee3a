"""Rules as SHACL rules (`.ttl`): sh:TripleRule where a rule follows a path from a subject, else sh:SPARQLRule.

    ?x :p ?y . ?y :q ?z          a shape whose targets are the subjects of :p,
    gives ?x :r ?z               with a triple rule from sh:this to the path ( :p :q )

All other rules are CONSTRUCT queries; they do not depend on the node that they are run for, so their shape has one
target, the name of the rule.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from pyoxigraph import BlankNode, Literal, NamedNode

from kg.rules import sparql
from kg.rules.decompose.work import Names
from kg.rules.form import Atom, Pattern, Rule, Variable
from kg.rules.printing.together import called, variables_of
from kg.rules.printing.words import construct, shortened, with_prefixes
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


_SH = "http://www.w3.org/ns/shacl#"
_PREBOUND = ("this", "shapesGraph", "currentShape")
"""Variables that have a value before a query of a shapes graph is evaluated (SHACL, appendix A)."""


def to_turtle(rules: Sequence[Rule], prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return a shapes graph with a shape for each rule.

    RuleError KG209 for atoms that match asserted triples only, and for blank nodes of the data.
    """
    text = "\n\n".join(_triple_rule(rule) or _sparql_rule(rule, prefixes) for rule in rules)
    known = {**prefixes, "sh": _SH}
    short, used = shortened(text, known)
    declared = "".join(f"@prefix {prefix}: <{known[prefix]}> .\n" for prefix in sorted({*used, "sh"}))
    return f"{declared}\n{short}"


def _shape(rule: Rule, target: str, kind: str, lines: list[str]) -> str:
    order = [f"sh:order {rule.order:g} ;"] if rule.order else []
    inner = sparql.indented("\n".join([f"a {kind} ;", *order, *lines]))
    name = f"<urn:kg:shape:{re.sub(r'[^A-Za-z0-9/_.-]', '-', rule.name)}:{rule.part}>"
    target = target or f"sh:targetNode {name}"
    return f"{name} a sh:NodeShape ;\n  {target} ;\n  sh:rule [\n{sparql.indented(inner)}\n  ] ."


def _sparql_rule(rule: Rule, prefixes: Mapping[str, str]) -> str:
    names = Names(variable.name for variable in variables_of(rule))
    rule = called(rule, {Variable(name): names.like(Variable(name)) for name in _PREBOUND})
    escaped = with_prefixes(construct(rule), prefixes).replace("\\", "\\\\").replace('"', '\\"')
    return _shape(rule, "", "sh:SPARQLRule", [f'sh:construct """\n{escaped}\n"""'])


def _triple_rule(rule: Rule) -> str | None:
    """Return a triple rule; None for a rule that is not a path from the subject of its head."""
    if len(rule.head) != 1 or not isinstance(rule.head[0].predicate, NamedNode):
        return None
    (head,) = rule.head
    steps = _path(rule, head.subject)
    if steps is None or not isinstance(head.subject, Variable):
        return None
    path, end = steps
    value = _object(head, end, path)
    if value is None:
        return None
    first, kind = (path[0], "Subjects") if path[0].startswith("<") else (path[0][1:], "Objects")
    lines = ["sh:subject sh:this ;", f"sh:predicate {head.predicate} ;", f"sh:object {value}"]
    return _shape(rule, f"sh:target{kind}Of {first}", "sh:TripleRule", lines)


def _path(rule: Rule, start: Pattern) -> tuple[list[str], Pattern] | None:
    """Return the steps of a body that is one chain of triples from a variable, each with a new one, and its end."""
    here, path, seen = start, [], {start}
    for element in rule.body:
        if not isinstance(element, Atom) or element.asserted or not isinstance(element.predicate, NamedNode):
            return None
        forth = element.subject == here
        there = element.object if forth else element.subject
        if (not forth and element.object != here) or there in seen or not isinstance(there, Variable):
            return None
        path.append(str(element.predicate) if forth else f"^{element.predicate}")
        here = there
        seen.add(there)
    return (path, here) if path else None


def _object(head: Atom, end: Pattern, path: list[str]) -> str | None:
    """Return the node expression of the head's object; a constant stands for itself where the path is one step."""
    if head.object == end:
        steps = [step if step.startswith("<") else f"[ sh:inversePath {step[1:]} ]" for step in path]
        return f"[ sh:path {steps[0] if len(steps) == 1 else '( ' + ' '.join(steps) + ' )'} ]"
    if len(path) > 1 or isinstance(head.object, BlankNode):
        return None
    if head.object == head.subject:
        return "sh:this"
    return str(head.object) if isinstance(head.object, NamedNode | Literal) else None
