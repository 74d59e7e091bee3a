"""From blocks to the text of a `.rq`, with the line that each block begins with."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from pyoxigraph import Literal

from kg.rules.blocks import tree
from kg.rules.files import HEADINGS
from kg.syntax.lexer import Kind, tokens_of
from kg.syntax.names import PREFIXES
from kg.syntax.printer import renamed

SECTIONS: Final = dict(zip(("infers", "why", "mend", "limits", "references"), HEADINGS, strict=True))
"""The member of a rule to the heading of its documentation."""

OPENING: Final = {tree.Absent: "FILTER NOT EXISTS", tree.Present: "FILTER EXISTS", tree.Perhaps: "OPTIONAL"}
_OPERATORS: Final = {"and": "&&", "or": "||"}
_MARKUP: Final = re.compile(r"## |(since|severity):")


@dataclass(frozen=True, slots=True)
class Written:
    """The text of a rule; `lines` has for a line, counted from one, the identity of the block that it belongs to."""

    text: str
    lines: Mapping[int, str]


@dataclass(slots=True)
class _Writer:
    lines: list[str] = field(default_factory=list)
    owners: dict[int, str] = field(default_factory=dict)

    def line(self, text: str, depth: int = 0, owner: str = "") -> None:
        """Add a line, or more of them where a text has some."""
        for each in text.split("\n"):
            self.lines.append("  " * depth + each if each else "")
            if owner:
                self.owners[len(self.lines)] = owner

    def conditions(self, conditions: Iterable[tree.Condition], depth: int) -> None:
        """Add conditions, one a line."""
        for one in conditions:
            self.condition(one, depth)

    def condition(self, one: tree.Condition, depth: int) -> None:
        """Add a condition and its content."""
        if isinstance(one, tree.Absent | tree.Present | tree.Perhaps):
            self.line(f"{OPENING[type(one)]} {{", depth, one.id)
            self.conditions(one.when, depth + 1)
            self.line("}", depth, one.id)
        elif isinstance(one, tree.Either):
            for index, branch in enumerate(one.branches):
                self.line("} UNION {" if index else "{", depth, one.id)
                self.conditions(branch, depth + 1)
            self.line("}", depth, one.id)
        else:
            self.line(_plain(one), depth, one.id)


def write(rule: tree.Rule) -> Written:
    """Return the text of a rule, documented as `kg rules new` documents one."""
    writer = _Writer()
    for line in _header(rule):
        writer.line(f"# {line}".rstrip())
    writer.line("")
    body = _Writer()
    _body(rule, body)
    body.lines = _marked("\n".join(body.lines)).split("\n")
    used = {token.text.partition(":")[0] for token in tokens_of("\n".join(body.lines)) if token.kind is Kind.NAME}
    declared = sorted(used & all_prefixes(rule).keys() - {"_"})
    for prefix in declared:
        writer.line(f"PREFIX {prefix}: <{all_prefixes(rule)[prefix]}>")
    if declared:
        writer.line("")
    start = len(writer.lines)
    writer.lines += body.lines
    writer.owners |= {number + start: owner for number, owner in body.owners.items()}
    return Written("\n".join(writer.lines) + "\n", writer.owners)


def _header(rule: tree.Rule) -> Iterator[str]:
    if title := " ".join(rule.title.split()):
        yield title.lstrip("#").strip() or "-"
        yield ""
    sections = {heading: getattr(rule, member) for member, heading in SECTIONS.items()}
    sections[SECTIONS["infers"]] = rule.infers.strip() or inferred(rule)
    for heading, text in sections.items():
        if text.strip():
            yield f"## {heading}"
            yield ""
            # A line that would be a heading or a key is moved to the right.
            yield from (f" {line}" if _MARKUP.match(line) else line for line in text.strip().splitlines())
            yield ""
    if rule.severity:
        yield f"severity: {rule.severity}"
    yield f"since: {rule.since}"


def inferred(rule: tree.Rule) -> str:
    """Return a sentence about what a rule infers, for a rule whose author gives none."""
    facts = [f"`{_plain(one).removesuffix(' .')}`" for one in rule.then]
    return f"{' and '.join(facts)}, for all that the pattern below finds." if facts else ""


def _body(rule: tree.Rule, writer: _Writer) -> None:
    if len(rule.then) == 1:
        (fact,) = rule.then
        writer.line(f"CONSTRUCT {{ {_plain(fact).removesuffix(' .')} }}", 0, fact.id)
    else:
        writer.line("CONSTRUCT {")
        writer.conditions(rule.then, 1)
        writer.line("}")
    writer.line("WHERE {")
    writer.conditions(rule.when, 1)
    writer.line("}")


def _marked(body: str) -> str:
    """Return a body with `_` before each name that occurs once, which marks it as intended."""
    names = Counter(token.text[1:] for token in tokens_of(body) if token.kind is Kind.VARIABLE)
    once = {
        name: f"_{name}" for name, uses in names.items() if uses == 1 and name[0] != "_" and f"_{name}" not in names
    }
    return renamed(body, once)


def namespace(rule: tree.Rule) -> str:
    """Return the namespace of `my:`: the terms of the rule's family, as `kg rules new` names them."""
    return f"https://example.org/{rule.name.rpartition('/')[0]}#"


def all_prefixes(rule: tree.Rule) -> dict[str, str]:
    """Return the prefixes that names in the rule may have."""
    return {**PREFIXES, "my": namespace(rule), **rule.prefixes}


def _plain(one: tree.Condition) -> str:
    """Return a condition that has no others in it."""
    if isinstance(one, tree.Fact):
        return f"{value(one.subject)} {one.property} {value(one.object)} ."
    if isinstance(one, tree.Is):
        return f"{value(one.subject)} a {one.kind} ."
    if isinstance(one, tree.Only):
        return f"FILTER({_bare(test(one.test))})"
    if isinstance(one, tree.Let):
        return f"BIND({_bare(value(one.value))} AS ?{one.name})"
    assert isinstance(one, tree.Other)  # noqa: S101 - what has others in it is written by its caller
    return one.text


def _bare(text: str) -> str:
    """Return an expression without the brackets around all of it."""
    return text[1:-1] if text.startswith("(") and text.endswith(")") else text


def value(one: tree.Value) -> str:
    """Return a value as SPARQL writes it, in brackets where it is made of others."""
    if isinstance(one, tree.Thing):
        return f"?{one.name}"
    if isinstance(one, tree.Name):
        return one.name
    if isinstance(one, tree.Number):
        return one.value
    if isinstance(one, tree.Truth):
        return "true" if one.value else "false"
    if isinstance(one, tree.Text):
        suffix = f"@{one.language}" if one.language else f"^^{one.datatype}" if one.datatype else ""
        return f"{Literal(one.value)}{suffix}"
    if isinstance(one, tree.Join):
        return f"CONCAT({', '.join(map(value, one.parts))})"
    if isinstance(one, tree.Of):
        return f"{one.function}({value(one.of)})"
    if isinstance(one, tree.Reckon):
        return f"({value(one.left)} {one.operator} {value(one.right)})"
    return f"({one.text})"


def test(one: tree.Test) -> str:
    """Return a test as SPARQL writes it, in brackets where it is made of others."""
    if isinstance(one, tree.Compare):
        return f"({value(one.left)} {one.operator} {value(one.right)})"
    if isinstance(one, tree.Match):
        return f"{one.how}({value(one.value)}, {value(one.text)})"
    if isinstance(one, tree.Bound):
        return f"BOUND(?{one.name})"
    if isinstance(one, tree.Logic):
        return f"({test(one.left)} {_OPERATORS[one.operator]} {test(one.right)})"
    if isinstance(one, tree.Not):
        return f"!{test(one.of)}"
    return f"({one.text})"
