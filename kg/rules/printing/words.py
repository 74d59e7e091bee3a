"""Rules as SPARQL CONSTRUCT (`.rq`), and what all printed notations share: short names, heads, refusals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.errors import RuleError
from kg.rules import sparql
from kg.rules.explain.closures import Closures
from kg.rules.form import Atom, Rule, atoms_of
from kg.rules.printing.together import together
from kg.syntax.lexer import Kind, Token
from kg.syntax.names import PREFIXES, prefixed
from kg.syntax.printer import respelt

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


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
