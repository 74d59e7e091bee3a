"""The manual of one rule: its documentation, what it reads and derives, and its relations to other rules."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kg.errors import RuleError
from kg.rules.authoring.examples import Example, read_examples
from kg.rules.authoring.graph import RuleGraph, rule_graph, spell_atom
from kg.rules.dependencies import reads
from kg.rules.files import HEADINGS, NOTATIONS, Documentation, RuleFile, parse_header
from kg.rules.form import Atom, atoms_of, is_auxiliary

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from pyoxigraph import Triple

    from kg.rules.authoring.library import Entry, Library


@dataclass(frozen=True, slots=True)
class Manual:
    """One rule for people.

    `reads`, `absent` (those whose absence or number it asks for) and `derives` are properties and classes; `strata`, of
    `of_strata`, are those it runs in, none when the rules in force have none; `fed_by` and `feeds` are other rules.
    """

    file: RuleFile
    reads: tuple[str, ...]
    absent: tuple[str, ...]
    derives: tuple[str, ...]
    strata: tuple[int, ...]
    of_strata: int
    fed_by: tuple[str, ...]
    feeds: tuple[str, ...]
    examples: tuple[Example, ...]
    problem: RuleError | None

    @property
    def sections(self) -> list[tuple[str, str]]:
        """The headings of the documentation with their text, in their order."""
        written = self.file.documentation.sections
        return [(heading, written[heading]) for heading in HEADINGS if heading in written]

    @property
    def lines(self) -> list[tuple[int, str]]:
        """The lines of the file below its header, with their numbers."""
        numbered = list(enumerate(self.file.text.splitlines(), 1))
        first = next((index for index, (_, line) in enumerate(numbered) if line.strip() and line[0] != "#"), 0)
        return numbered[first:]


def manual(library: Library, entry: Entry, schema: Iterable[Triple] = (), cached: RuleGraph | None = None) -> Manual:
    """Return the manual of a rule among others cut to `schema`; raises what reading its file raises.

    `cached` is the graph of the rules in force, if the caller has it.
    """
    file = library.read(entry.name)
    prefixes = file.all_prefixes
    atoms = list(_atoms(file))
    absent = _spelt((atom for atom, negated in atoms if negated), prefixes)
    graph, problem = _graph(library, schema) if cached is None else (cached, None)
    strata = sorted({number for node in graph.rules if node.name == file.name for number in node.strata})
    examples, problem = _examples(entry, problem)
    return Manual(
        file,
        tuple(term for term in _spelt((atom for atom, _ in atoms), prefixes) if term not in absent),
        absent,
        _spelt((atom for rule in file.rules for atom in rule.head), prefixes),
        tuple(strata),
        max((node.strata[-1] for node in graph.rules), default=0),
        tuple(graph.fed_by(file.name)),
        tuple(graph.feeds(file.name)),
        examples,
        problem,
    )


def _atoms(file: RuleFile) -> Iterator[tuple[Atom, bool]]:
    """Yield the atoms that the rules of a file read, asserted data too, and whether they test absence or number."""
    for rule in file.rules:
        yield from atoms_of(rule.body)
        yield from ((each.atom, each.negated) for each in reads(rule))


def _spelt(atoms: Iterable[Atom], prefixes: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(sorted({spell_atom(atom, prefixes) for atom in atoms if not is_auxiliary(atom.predicate)}))


def _graph(library: Library, schema: Iterable[Triple]) -> tuple[RuleGraph, RuleError | None]:
    """Return the dependencies of all rules that can be read, and the first error that hides a part of them."""
    files, errors = library.read_all()
    try:
        return rule_graph(files, schema), errors[0] if errors else None
    except RuleError as error:
        return RuleGraph((), (), {}, {}), error


def _examples(entry: Entry, problem: RuleError | None) -> tuple[tuple[Example, ...], RuleError | None]:
    try:
        return read_examples(entry.examples) if entry.examples.is_file() else (), problem
    except RuleError as error:
        return (), problem or error


def documentation(entry: Entry) -> Documentation:
    """Return the documentation of a rule without reading the rule itself; RuleError KG206 when it is malformed."""
    try:
        text = entry.path.read_text("utf-8", errors="replace")
    except OSError:
        text = ""
    return parse_header(text, str(entry.path))


def documented(library: Library, entry: Entry) -> tuple[Documentation, RuleError | None]:
    """Return the documentation of a rule, as far as it can be read, and the error for which the rule cannot be."""
    try:
        return library.read(entry.name).documentation, None
    except RuleError as error:
        with suppress(RuleError):
            return documentation(entry), error
        return Documentation(), error


def entry_object(entry: Entry, documentation: Documentation, error: RuleError | None = None) -> dict[str, Any]:
    """Return a rule in a list as plain values, ready for JSON; `error` is why it cannot be read."""
    return {
        "rule": entry.name,
        "family": entry.family,
        "title": documentation.title,
        "notation": entry.path.suffix.lstrip("."),
        "since": documentation.since,
        "severity": documentation.severity,
        "pack": entry.pack or None,
        "in_force": entry.in_force,
        "error": {"code": error.code, "message": error.message, "place": str(error.place or "")} if error else None,
        "file": str(entry.path),
        "examples": str(entry.examples) if entry.examples.is_file() else None,
    }


def manual_object(entry: Entry, page: Manual) -> dict[str, Any]:
    """Return all that is known of a rule as plain values, ready for JSON."""
    return {
        **entry_object(entry, page.file.documentation),
        "notation_name": NOTATIONS[page.file.notation],
        "documentation": dict(page.sections),
        "reads": list(page.reads),
        "absent": list(page.absent),
        "derives": list(page.derives),
        "strata": list(page.strata),
        "of_strata": page.of_strata,
        "fed_by": list(page.fed_by),
        "feeds": list(page.feeds),
        "example_titles": [example.title for example in page.examples],
        "text": page.file.text,
    }
