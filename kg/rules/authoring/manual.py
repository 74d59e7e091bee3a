"""What is known of one rule: its documentation, what it reads and derives, where it stands among the others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kg.errors import RuleError
from kg.query.prefixes import PREFIXES
from kg.rules.authoring.examples import read_examples
from kg.rules.authoring.graph import rule_graph, spell_atom
from kg.rules.dependencies import reads, writes
from kg.rules.files import HEADINGS, NOTATIONS
from kg.rules.form import AUXILIARY
from kg.rules.header import parse_header

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.rules.authoring.examples import Example
    from kg.rules.authoring.graph import RuleGraph
    from kg.rules.authoring.library import Entry, Library
    from kg.rules.files import Documentation, RuleFile
    from kg.rules.form import Atom

__all__ = ["Manual", "documentation", "entry_object", "manual", "manual_object"]


@dataclass(frozen=True, slots=True)
class Manual:
    """One rule for people.

    `reads`, `absent` (those whose absence or number it asks for) and `derives` are properties and classes; `stratum`
    and `strata` count from one, None when the rules in force have no strata; `fed_by` and `feeds` are other rules.
    """

    file: RuleFile
    reads: tuple[str, ...]
    absent: tuple[str, ...]
    derives: tuple[str, ...]
    stratum: int | None
    strata: int
    fed_by: tuple[str, ...]
    feeds: tuple[str, ...]
    examples: tuple[Example, ...]
    problem: RuleError | None

    @property
    def sections(self) -> list[tuple[str, str]]:
        """The headings of the documentation with their text, in their order."""
        written = self.file.documentation.sections or {}
        return [(heading, written[heading]) for heading in HEADINGS if heading in written]

    @property
    def lines(self) -> list[tuple[int, str]]:
        """The lines of the file below its header, with their numbers."""
        numbered = list(enumerate(self.file.text.splitlines(), 1))
        first = next((index for index, (_, line) in enumerate(numbered) if line.strip() and line[0] != "#"), 0)
        return numbered[first:]


def manual(library: Library, entry: Entry) -> Manual:
    """Return what is known of a rule; raises what reading its file raises."""
    file = library.read(entry.name)
    prefixes = {**PREFIXES, **{name: iri for name, iri in (file.prefixes or {}).items() if name}}
    read = [each for rule in file.rules for each in reads(rule)]
    absent = _spelt((each.atom for each in read if each.negated), prefixes)
    graph, problem = _graph(library)
    node = next((node for node in graph.rules if node.name == file.name), None) if graph else None
    examples, problem = _examples(entry, problem)
    return Manual(
        file,
        tuple(term for term in _spelt((each.atom for each in read), prefixes) if term not in absent),
        absent,
        _spelt((atom for rule in file.rules for atom in writes(rule)), prefixes),
        node.stratum if node else None,
        max((node.stratum for node in graph.rules), default=0) if graph else 0,
        _others(graph, file.name, before=True),
        _others(graph, file.name, before=False),
        examples,
        problem,
    )


def _spelt(atoms: Iterable[Atom], prefixes: Mapping[str, str]) -> tuple[str, ...]:
    shown = (atom for atom in atoms if not str(atom.predicate).startswith(f"<{AUXILIARY}"))
    return tuple(sorted({spell_atom(atom, prefixes) for atom in shown}))


def _graph(library: Library) -> tuple[RuleGraph | None, RuleError | None]:
    """Return the dependencies of all rules that can be read, and the first error that hides a part of them."""
    files, errors = library.read_all()
    try:
        return rule_graph(files), errors[0] if errors else None
    except RuleError as error:
        return None, error


def _examples(entry: Entry, problem: RuleError | None) -> tuple[tuple[Example, ...], RuleError | None]:
    try:
        return read_examples(entry.examples) if entry.examples.is_file() else (), problem
    except RuleError as error:
        return (), problem or error


def _others(graph: RuleGraph | None, name: str, *, before: bool) -> tuple[str, ...]:
    """Return the rules that derive what this one reads, or read what it derives."""
    if graph is None:
        return ()
    if before:
        terms = {term for term, rule in graph.reads if rule == name}
        found = {rule for rule, term in graph.derives if term in terms}
    else:
        terms = {term for rule, term in graph.derives if rule == name}
        found = {rule for term, rule in graph.reads if term in terms}
    return tuple(sorted(found))


def documentation(entry: Entry) -> Documentation:
    """Return the documentation of a rule without reading the rule itself; RuleError KG206 when it is malformed."""
    try:
        text = entry.path.read_text("utf-8", errors="replace")
    except OSError:
        text = ""
    return parse_header(text, str(entry.path))


def entry_object(entry: Entry, told: Documentation) -> dict[str, Any]:
    """Return a rule in a list as plain values, ready for JSON."""
    return {
        "rule": entry.name,
        "family": entry.family,
        "title": told.title,
        "notation": entry.path.suffix.lstrip("."),
        "since": told.since,
        "severity": told.severity,
        "pack": entry.pack or None,
        "file": str(entry.path),
        "examples": str(entry.examples) if entry.examples.is_file() else None,
    }


def manual_object(entry: Entry, known: Manual) -> dict[str, Any]:
    """Return all that is known of a rule as plain values, ready for JSON."""
    return {
        **entry_object(entry, known.file.documentation),
        "notation_name": NOTATIONS[known.file.notation],
        "documentation": dict(known.sections),
        "reads": list(known.reads),
        "absent": list(known.absent),
        "derives": list(known.derives),
        "stratum": known.stratum,
        "strata": known.strata,
        "fed_by": list(known.fed_by),
        "feeds": list(known.feeds),
        "example_titles": [example.title for example in known.examples],
        "text": known.file.text,
    }
