"""Rules as SPARQL CONSTRUCT (`.rq`), and what all printed notations share: short names, heads, refusals.

Several rules become one CONSTRUCT, whose pattern is the union of their bodies. The template of a query is filled from
every solution, so a triple of one rule must have a variable that the bodies of the others do not bind: CONSTRUCT leaves
it out there. Rules with other heads get variables of their own for that.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pyoxigraph import BlankNode

from kg.errors import Place, RuleError
from kg.rules import sparql
from kg.rules.decompose.renaming import everywhere, renamed
from kg.rules.decompose.work import Names
from kg.rules.explain.closures import Closures
from kg.rules.form import Atom, Pattern, Rule, TripleTerm, Variable, atoms_of, binds, bound_in, is_auxiliary
from kg.syntax.lexer import Kind, Token
from kg.syntax.names import PREFIXES, prefixed
from kg.syntax.printer import respelt

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

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
