"""Rules of the internal form as text: SPARQL CONSTRUCT (`.rq`), SPARQL 1.2 RL (`.srl`), SHACL (`.ttl`), and the form.

Each function takes all rules of a file and returns the text of one. A rule that a notation cannot express raises
RuleError KG209 with the part.

Several rules become one CONSTRUCT, whose pattern is the union of their bodies. The template of a query is filled from
every solution, so a triple of one rule must have a variable that the bodies of the others do not bind: CONSTRUCT leaves
it out there. Rules with other heads get variables of their own for that.

In SHACL, a path becomes a triple rule:

    ?x :p ?y . ?y :q ?z          a shape whose targets are the subjects of :p,
        gives ?x :r ?z               with a triple rule from sh:this to the path ( :p :q )

All other rules are CONSTRUCT queries; they do not depend on the node that they are run for, so their shape has one
target, the name of the rule.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pyoxigraph import BlankNode, Literal, NamedNode

from kg.errors import Place, RuleError
from kg.rules import form, sparql
from kg.rules.decompose.expressions import expression
from kg.rules.decompose.parts import Names
from kg.rules.decompose.renaming import everywhere, renamed
from kg.rules.dependencies import reads
from kg.rules.explain.closures import Closures
from kg.rules.form import (
    Aggregate,
    Assignment,
    Atom,
    Element,
    EngineBlock,
    Exists,
    Filter,
    Pattern,
    Rule,
    TripleTerm,
    Variable,
    atoms_of,
    binds,
    bound_in,
    is_auxiliary,
)
from kg.rules.notations.shacl.query import EXCLUDED, PREBOUND
from kg.syntax.functions import FUNCTIONS, RULE_FUNCTIONS
from kg.syntax.lexer import Kind, Token, bare, tokens_of
from kg.syntax.names import PREFIXES, prefixed
from kg.syntax.printer import respelt

if TYPE_CHECKING:
    from pyoxigraph import Triple

    from kg.rules.files import RuleFile


def to_rq(rules: Sequence[Rule], prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return the CONSTRUCT query that derives what rules derive together.

    RuleError KG209 for atoms that match asserted triples only, for blank nodes of the data, and for rules whose heads
    have no variable in common with their bodies, of which a query can have only one.
    """
    merged = together(rules)
    if merged is None:
        hint = "Print them as .srl or .ttl, or put each into a file of its own."
        raise refusal(rules[0], "and others of its file have heads that one CONSTRUCT cannot tell apart", hint)
    closures = Closures.of(rules)
    bodies = list(dict.fromkeys(_body(rule, closures) for rule in merged))
    template = head(dict.fromkeys(atom for rule in merged for atom in rule.head))
    return with_prefixes(_query(template, bodies), prefixes)


def construct(rule: Rule) -> str:
    """Return the CONSTRUCT query of one rule, names as IRIs in brackets."""
    return _query(head(rule.head), [_body(rule, Closures())])


def _body(rule: Rule, closures: Closures) -> str:
    if any(atom.asserted for atom, _ in atoms_of(rule.body)):
        hint = "SPARQL RL can express it: print it as .srl."
        raise refusal(rule, "reads asserted data alone, which SPARQL has no word for", hint)
    return sparql.group(closures.written(rule.body))


def _query(template: str, bodies: Sequence[str]) -> str:
    if len(bodies) > 1:
        bodies = ["\nUNION\n".join(f"{{\n{sparql.indented(body)}\n}}" for body in bodies)]
    return f"CONSTRUCT {{\n{sparql.indented(template)}\n}}\nWHERE {{\n{sparql.indented(bodies[0])}\n}}"


def shortened(text: str, prefixes: Mapping[str, str] = PREFIXES) -> tuple[str, tuple[str, ...]]:
    """Return text in the terminals of SPARQL with prefixed names where a prefix fits, and the prefixes used."""
    used: set[str] = set()

    def spelling(token: Token) -> str | None:
        short = prefixed(token.text[1:-1], prefixes) if token.kind is Kind.IRI else None
        if short is None:
            return None
        used.add(short[0])
        return ":".join(short)

    return respelt(text, spelling), tuple(sorted(used))


def with_prefixes(text: str, prefixes: Mapping[str, str]) -> str:
    """Return text with prefixed names, behind the declarations that it needs."""
    short, used = shortened(text, prefixes)
    declared = "".join(f"PREFIX {prefix}: <{prefixes[prefix]}>\n" for prefix in used)
    return f"{declared}\n{short}" if declared else short


def head(atoms: Iterable[Atom]) -> str:
    """Return the triples of a head, one a line."""
    return "\n".join(f"{sparql.triple(atom)} ." for atom in atoms)


def refusal(rule: Rule, what: str, hint: str) -> RuleError:
    """Return the error for a part of a rule that a notation cannot express."""
    return RuleError("KG209", f"rule `{rule}` {what}", place=rule.place, hint=hint)


def together(rules: Sequence[Rule]) -> list[Rule] | None:
    """Return rules that a CONSTRUCT of all their heads and the union of their bodies expresses.

    Auxiliary rules are left out. None if a head has no variable to tell it from the others.
    """
    groups: list[list[Rule]] = []
    for rule in rules:
        if not is_auxiliary(rule.head[0].predicate):
            # Two rules never share the nodes that they create.
            fitting = next((group for group in groups if not rule.creates_nodes and _fit([*group, rule])), None)
            if fitting is None:
                groups.append([rule])
            else:
                fitting.append(rule)
    if len(groups) > 1:
        names = Names(variable.name for rule in rules for variable in variables_of(rule))
        groups = [_apart(group, number, names) for number, group in enumerate(groups, 1)]
    ordered = [rule for group in groups for rule in group]
    return ordered if _fit(ordered) else None


def of_data(file: RuleFile) -> Iterator[Rule]:
    """Yield the rule without a pattern that derives the triples of DATA, if a file has any."""
    if file.data:
        stated = tuple(Atom(triple.subject, triple.predicate, triple.object) for triple in file.data)
        yield Rule(file.name, stated, (), Place(str(file.path)), part=len(file.rules) + 1)


def _fit(rules: Sequence[Rule]) -> bool:
    """Return whether no body binds all variables of a triple that its rule does not derive."""
    template = {atom for rule in rules for atom in rule.head}
    return all(not binds(atom) <= bound_in(rule.body) for rule in rules for atom in template.difference(rule.head))


def variables_of(rule: Rule) -> frozenset[Variable]:
    """Return the variables of a rule, at any depth."""
    return everywhere(rule.body).union(*map(binds, rule.head))


def called(rule: Rule, names: Mapping[Variable, Variable]) -> Rule:
    """Return a rule with other names for variables."""
    return replace(rule, head=tuple(atom.replaced(names) for atom in rule.head), body=renamed(rule.body, names))


def _apart(group: Sequence[Rule], number: int, names: Names) -> list[Rule]:
    """Return rules with variables and labels of their own."""
    own = sorted(frozenset().union(*map(variables_of, group)), key=str)
    new = {variable: names.like(variable) for variable in own}
    result = []
    for rule in (called(rule, new) for rule in group):
        labelled = (
            replace(atom, subject=_label(atom.subject, number), object=_label(atom.object, number))
            for atom in rule.head
        )
        result.append(replace(rule, head=tuple(labelled)))
    return result


def _label(pattern: Pattern, number: int) -> Pattern:
    if isinstance(pattern, BlankNode):
        return BlankNode(f"g{number}-{pattern.value}")
    if isinstance(pattern, TripleTerm):
        return TripleTerm(*(_label(part, number) for part in pattern))
    return pattern


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
        keys = f" by {_spelt(element.keys)}" if element.keys else ""
        return _below(f"group{keys}: {', '.join(columns)}", element.body)
    if isinstance(element, EngineBlock):
        optional = f", maybe {_spelt(element.optional)}" if element.optional else ""
        reading = "anything" if element.reads is None else " ".join(sorted(map(str, element.reads))) or "nothing"
        monotone = "" if element.monotone else "; not monotone"
        title = f"engine gives {_spelt(element.variables)}{optional}; reads {reading}{monotone}"
        return f"{title}\n{sparql.indented(element.text)}"
    return sparql.group((element,))


def _below(title: str, body: Iterable[Element]) -> str:
    return "\n".join([title, *(sparql.indented(_element(element)) for element in body)])


def _spelt(variables: Iterable[Variable]) -> str:
    return " ".join(map(sparql.spelling, variables))


_MISSING = {
    form.Aggregate: "aggregates",
    form.EngineBlock: "more of SPARQL than patterns and filters, which was left to the store's engine",
    form.Values: "VALUES",
    form.Exists: "EXISTS",
}

_MIXED = "reads asserted data for a part of its body"


def to_srl(rules: Sequence[form.Rule], prefixes: Mapping[str, str] = PREFIXES, data: Sequence[Triple] = ()) -> str:
    """Return the rules, and the triples that their file states, as a rule set.

    RuleError KG209 for aggregates, VALUES, EXISTS, blocks of SPARQL, and functions that SPARQL RL lacks; for a body
    that mixes asserted and other triples in one place; for blank nodes of the data.
    """
    stated = head(form.Atom(triple.subject, triple.predicate, triple.object) for triple in data)
    parts = [f"DATA {{\n{sparql.indented(stated)}\n}}"] if stated else []
    return with_prefixes("\n\n".join([*parts, *map(_rule, rules)]), prefixes)


def _rule(rule: form.Rule) -> str:
    data = "DATA " if _only_asserted(rule, rule.body) else ""
    body = "\n".join(_elements(rule, rule.body, asserted=bool(data)))
    return f"RULE {{\n{sparql.indented(head(rule.head))}\n}} WHERE {data}{{\n{sparql.indented(body)}\n}}"


def _only_asserted(rule: form.Rule, body: tuple[form.Element, ...]) -> bool:
    """Return whether the triples of a body are asserted ones."""
    kinds = {element.asserted for element in body if isinstance(element, form.Atom)}
    if len(kinds) > 1:
        raise refusal(rule, _MIXED, "SPARQL RL has DATA for a whole body or NOT.")
    return kinds == {True}


def _elements(
    rule: form.Rule, body: tuple[form.Element, ...], *, asserted: bool, inside: bool = False
) -> Iterator[str]:
    for element in body:
        if isinstance(element, form.Atom):
            yield sparql.group((form.Atom(*element.positions, place=element.place),))
        elif isinstance(element, form.Filter):
            yield f"FILTER({_expression(rule, element.expression)})"
        elif isinstance(element, form.Assignment) and not inside:
            yield f"SET({sparql.spelling(element.variable)} := {_expression(rule, element.expression)})"
        elif isinstance(element, form.Exists) and element.negated and not inside:
            yield _negation(rule, element, asserted=asserted)
        else:
            what = _MISSING.get(type(element), "an assignment inside NOT")
            raise refusal(rule, f"has {what}; SPARQL RL has none", "Print it as .rq.")


def _negation(rule: form.Rule, element: form.Exists, *, asserted: bool) -> str:
    if asserted and not all(atom.asserted for atom, _ in form.atoms_of(element.body)):
        raise refusal(rule, _MIXED, "SPARQL RL has DATA for a whole body or NOT.")
    data = "DATA " if not asserted and _only_asserted(rule, element.body) else ""
    inner = "\n".join(_elements(rule, element.body, asserted=asserted, inside=True))
    return f"NOT {data}{{\n{sparql.indented(inner)}\n}}"


def _expression(rule: form.Rule, expression: form.Expression) -> str:
    for token in tokens_of(expression.text):
        name = token.text.upper()
        if token.kind is Kind.WORD and name in FUNCTIONS and name not in RULE_FUNCTIONS:
            raise refusal(rule, f"calls {name}; SPARQL RL has no such function", "Print it as .rq.")
    return bare(expression.text)


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
