"""Checks of what belongs to a rule: its text, its documentation and its examples (KG201, KG218, KG219, KG221)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

from kg.errors import Place, RuleError
from kg.rules.authoring.examples import read_examples
from kg.rules.checks.finding import Context, Finding, at_rule, from_error
from kg.rules.files import REQUIRED_HEADINGS, Documentation, RuleFile
from kg.syntax.position import place_of

_RULES: Final = {
    ".rq": "A rule derives triples: CONSTRUCT { ... } WHERE { ... }, with filters that can hold.",
    ".srl": "A rule derives triples: RULE { ... } WHERE { ... }.",
    ".ttl": "A rule is the value of `sh:rule` at a shape with a target.",
}
"""How a rule is written in each notation."""

SCAFFOLD: Final = "Say here which question can be answered with it."
"""What the templates of new rules say below `## Why`."""

_NOTHING: Final = ("", SCAFFOLD)

_WORDS: Final = {
    "title": ("a title", "`# What it derives, in a line`"),
    "infers": ("text below `## What it infers`", "`# ## What it infers` and what triples from which"),
    "why": ("text below `## Why`", "`# ## Why` and which question can be answered with it"),
    "since": ("`since:`", "`# since: 0.1`, the version of yours that has it first"),
}
"""What may be lacking: what the message calls it, and how it is written."""


def no_rule(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding for a file that neither derives nor states anything."""
    if not file.rules and not file.data:
        place = place_of(file.text, 1, 1, str(file.path))
        yield Finding("KG201", "warning", file.name, "no rule here can infer anything", place, _RULES[file.notation])


def documentation_missing(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding that names all that the header of a file lacks."""
    if not file.rules and not file.data:
        return
    lacks = tuple(_lacking(file.documentation))
    if lacks:
        place = place_of(file.text, 1, 1, str(file.path))
        message = f"the header lacks {', '.join(_WORDS[each][0] for each in lacks)}"
        hint = f"Write above the rule: {'; '.join(_WORDS[each][1] for each in lacks)}."
        yield Finding("KG218", "warning", file.name, message, place, hint, lacks)


def _lacking(documentation: Documentation) -> Iterator[str]:
    sections = documentation.sections
    if not documentation.title:
        yield "title"
    for member, heading in zip(("infers", "why"), REQUIRED_HEADINGS, strict=True):
        if sections.get(heading, "").strip() in _NOTHING:
            yield member
    if not documentation.since:
        yield "since"


def examples_missing(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding for a file without examples."""
    if (file.rules or file.data) and not file.examples.is_file():
        hint = f"Write {file.examples.name} with a block `turtle given` and a block `turtle expect`."
        yield Finding("KG219", "warning", file.name, "the rule has no examples", at_rule(file), hint)


def examples_malformed(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield the first reason why the examples of a file cannot be read; the rule runs all the same."""
    if file.examples.is_file():
        try:
            read_examples(file.examples)
        except RuleError as error:
            yield replace(from_error(error, file.name, Place(str(file.examples), 1, 1)), severity="warning")


def orphan(path: Path, name: str) -> Finding | None:
    """Return the note that a page of examples has no rule next to it; None for a page without examples."""
    try:
        read_examples(path)
    except RuleError:
        return None
    hint = f"Name the rule {path.stem}.rq, {path.stem}.srl or {path.stem}.ttl, or remove the page."
    return Finding("KG221", "note", name, "no rule belongs to these examples", Place(str(path), 1, 1), hint)
