"""Rules as SPARQL CONSTRUCT (`.rq`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules import sparql
from kg.rules.form import atoms_of
from kg.rules.printing.words import head, refusal, with_prefixes
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.rules.form import Rule


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
        hint = "SPARQL RL says that: print it as .srl."
        raise refusal(rule, "reads asserted data alone, which SPARQL has no word for", hint)
    body = sparql.indented(sparql.group(rule.body))
    return f"CONSTRUCT {{\n{sparql.indented(head(rule.head))}\n}}\nWHERE {{\n{body}\n}}"
