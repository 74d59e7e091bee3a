"""Rules as SPARQL CONSTRUCT (`.rq`), and what all printed notations share: short names, heads, refusals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.errors import RuleError
from kg.rules import sparql
from kg.rules.form import Atom, Rule, atoms_of
from kg.syntax.lexer import Kind, Token
from kg.syntax.names import PREFIXES, prefixed
from kg.syntax.printer import respelt

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


def to_rq(rules: Sequence[Rule], prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return a CONSTRUCT query for each rule, behind a comment with its name where there are several.

    A file of rules has one: several are files of their own. RuleError KG209 for atoms that match asserted triples
    only, and for blank nodes of the data.
    """
    texts = [with_prefixes(construct(rule), prefixes) for rule in rules]
    if len(texts) > 1:
        texts = [f"# {rule}\n{text}" for rule, text in zip(rules, texts, strict=True)]
    return "\n\n".join(texts)


def construct(rule: Rule) -> str:
    """Return the CONSTRUCT query of one rule, names as IRIs in brackets."""
    if any(atom.asserted for atom, _ in atoms_of(rule.body)):
        hint = "SPARQL RL can express it: print it as .srl."
        raise refusal(rule, "reads asserted data alone, which SPARQL has no word for", hint)
    body = sparql.indented(sparql.group(rule.body))
    return f"CONSTRUCT {{\n{sparql.indented(head(rule.head))}\n}}\nWHERE {{\n{body}\n}}"


def shortened(text: str, prefixes: Mapping[str, str] = PREFIXES) -> tuple[str, tuple[str, ...]]:
    """Return text in the terminals of SPARQL with prefixed names where a prefix fits, and the prefixes used."""
    used: set[str] = set()

    def spelling(token: Token) -> str | None:
        found = prefixed(token.text[1:-1], prefixes) if token.kind is Kind.IRI else None
        if found is None:
            return None
        used.add(found[0])
        return ":".join(found)

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
