"""Rules as SHACL rules (`.ttl`): sh:TripleRule where a rule follows a path from a subject, else sh:SPARQLRule.

    ?x :p ?y . ?y :q ?z          a shape whose targets are the subjects of :p,
    gives ?x :r ?z               with a triple rule from sh:this to the path ( :p :q )

All other rules are CONSTRUCT queries; they do not depend on the node that they are run for, so their shape has one
target, the name of the rule.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from pyoxigraph import BlankNode, Literal, NamedNode

from kg.rules import form, sparql
from kg.rules.decompose.expressions import expression
from kg.rules.decompose.work import Names
from kg.rules.notations.shacl.query import EXCLUDED, PREBOUND
from kg.rules.printing.rq import called, construct, refusal, shortened, variables_of, with_prefixes
from kg.syntax.lexer import Kind, tokens_of
from kg.syntax.names import PREFIXES

_SH = "http://www.w3.org/ns/shacl#"


def to_turtle(rules: Sequence[form.Rule], prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return a shapes graph with a shape for each rule.

    RuleError KG209 for atoms that match asserted triples only, for blank nodes of the data, and for MINUS and VALUES in
    a block of SPARQL, which SHACL excludes.
    """
    text = "\n\n".join(_path_rule(rule) or _query_rule(rule, prefixes) for rule in rules)
    all_prefixes = {**prefixes, "sh": _SH}
    short, used = shortened(text, all_prefixes)
    declared = "".join(f"@prefix {prefix}: <{all_prefixes[prefix]}> .\n" for prefix in sorted({*used, "sh"}))
    return f"{declared}\n{short}"


def _shape(rule: form.Rule, target: str, kind: str, lines: list[str]) -> str:
    order = [f"sh:order {rule.order:g} ;"] if rule.order else []
    inner = sparql.indented("\n".join([f"a {kind} ;", *order, *lines]))
    name = f"<urn:kg:shape:{re.sub(r'[^A-Za-z0-9/_.-]', '-', rule.name)}:{rule.part}>"
    target = target or f"sh:targetNode {name}"
    return f"{name} a sh:NodeShape ;\n  {target} ;\n  sh:rule [\n{sparql.indented(inner)}\n  ] ."


def _query_rule(rule: form.Rule, prefixes: Mapping[str, str]) -> str:
    names = Names(variable.name for variable in variables_of(rule))
    rule = called(rule, {form.Variable(name): names.like(form.Variable(name)) for name in PREBOUND})
    rule = replace(rule, body=tuple(_without_values(rule, rule.body, frozenset(), names)))
    escaped = with_prefixes(construct(rule), prefixes).replace("\\", "\\\\").replace('"', '\\"')
    return _shape(rule, "", "sh:SPARQLRule", [f'sh:construct """\n{escaped}\n"""'])


def _without_values(
    rule: form.Rule, body: Sequence[form.Element], bound: frozenset[form.Variable], names: Names
) -> Iterator[form.Element]:
    """Yield a body without VALUES, which SHACL excludes; `bound` are the variables bound before it."""
    for element in body:
        if isinstance(element, form.Values):
            yield from _alternatives(element, bound, names)
        elif isinstance(element, form.Exists | form.Aggregate):
            seen = bound if isinstance(element, form.Exists) else frozenset[form.Variable]()
            yield replace(element, body=tuple(_without_values(rule, element.body, seen, names)))
        else:
            words = tokens_of(element.text) if isinstance(element, form.EngineBlock) else ()
            excluded = next((one for one in words if one.kind is Kind.WORD and one.text.upper() in EXCLUDED), None)
            if excluded is not None:
                what = f"has {excluded.text.upper()} in a part that SHACL cannot express"
                raise refusal(rule, what, "Print it as .rq.")
            yield element
        bound |= form.binds(element)


def _alternatives(element: form.Values, bound: frozenset[form.Variable], names: Names) -> Iterator[form.Element]:
    """Yield the rows of VALUES as a union of assignments, to new variables that are compared with those known."""
    if not element.rows:
        yield form.Filter(expression("false"))
        return
    new = {variable: names.like(variable) for variable in element.variables if variable in bound}
    columns = tuple(new.get(variable, variable) for variable in element.variables)
    spelt = [sparql.spelling(column) for column in columns]
    groups = (
        " ".join(f"BIND({sparql.term(cell)} AS {name})" for name, cell in zip(spelt, row, strict=True))
        for row in element.rows
    )
    yield form.EngineBlock(" UNION ".join(f"{{ {group} }}" for group in groups), columns)
    for old, fresh in new.items():
        yield form.Filter(expression(f"sameTerm({sparql.spelling(old)}, {sparql.spelling(fresh)})"))


def _path_rule(rule: form.Rule) -> str | None:
    """Return a triple rule; None for a rule that is not a path from the subject of its head."""
    if len(rule.head) != 1 or not isinstance(rule.head[0].predicate, NamedNode):
        return None
    (head,) = rule.head
    steps = _path(rule, head.subject)
    if steps is None or not isinstance(head.subject, form.Variable):
        return None
    path, end = steps
    value = _object(head, end, path)
    if value is None:
        return None
    first, kind = (path[0], "Subjects") if path[0].startswith("<") else (path[0][1:], "Objects")
    lines = ["sh:subject sh:this ;", f"sh:predicate {head.predicate} ;", f"sh:object {value}"]
    return _shape(rule, f"sh:target{kind}Of {first}", "sh:TripleRule", lines)


def _path(rule: form.Rule, start: form.Pattern) -> tuple[list[str], form.Pattern] | None:
    """Return the steps of a body that is one chain of triples from a variable, each with a new one, and its end."""
    here, path, seen = start, [], {start}
    for element in rule.body:
        if not isinstance(element, form.Atom) or element.asserted or not isinstance(element.predicate, NamedNode):
            return None
        forth = element.subject == here
        there = element.object if forth else element.subject
        if (not forth and element.object != here) or there in seen or not isinstance(there, form.Variable):
            return None
        path.append(str(element.predicate) if forth else f"^{element.predicate}")
        here = there
        seen.add(there)
    return (path, here) if path else None


def _object(head: form.Atom, end: form.Pattern, path: list[str]) -> str | None:
    """Return the node expression of the head's object; a constant stands for itself where the path is one step."""
    if head.object == end:
        steps = [step if step.startswith("<") else f"[ sh:inversePath {step[1:]} ]" for step in path]
        return f"[ sh:path {steps[0] if len(steps) == 1 else '( ' + ' '.join(steps) + ' )'} ]"
    if len(path) > 1 or isinstance(head.object, BlankNode):
        return None
    if head.object == head.subject:
        return "sh:this"
    return str(head.object) if isinstance(head.object, NamedNode | Literal) else None
