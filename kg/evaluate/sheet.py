"""A sheet of sampled facts for a person to judge, and the precision in a judged sheet.

The sample is stratified: every relation gets the same number of rows, as far as it has facts. So a sheet gives the
precision of each relation, and that of all facts by weighing relations by their size.
"""

from __future__ import annotations

import csv
import io
import random
from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import Place, UsageError
from kg.evaluate.completeness import share
from kg.evaluate.tables import Cell, Table, safe_cell, shares_of, weighed
from kg.facts import Interface, Location, Role
from kg.graph import vocabulary as v
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.lint.lines import Lines
from kg.query.rows import rows
from kg.render.text import count
from kg.rules.selecting import columns_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.facts import Parameter
    from kg.graph.source_states import SourceState
    from kg.store.snapshot import EmbeddedSnapshot


_PARAMETER: Final = "has parameter"
STATED: Final = (*(role.relation for role in Role), _PARAMETER)
"""Relations read from code."""
INFERRED: Final = {
    "has function": v.rnkg("hasFunction"),
    "uses hardware": v.rnkg("usesHardware"),
    "has capability": v.rnkg("hasCapability"),
}
"""Inferred relations."""
RELATIONS: Final = (*STATED, *INFERRED)
_RULED: Final = "SELECT ?node ?what { ?node %s ?what . ?node a rnkg:NodeType }"


@dataclass(frozen=True, slots=True)
class Fact:
    """A statement about a node, with its place; an inferred one has the place of its node.

    `repository` is the node's source, `file_repository` that of the file. `value` is the name of the end or parameter,
    None if it is unknown, or the label of the inferred class; `written` is the expression in the code.
    """

    relation: str
    repository: str
    package: str
    node: str
    value: str | None
    type: str | None
    written: str | None
    file_repository: str
    path: str
    line: int
    call: Location | None = None
    """The call of the framework, if it is in a wrapper or base class of another package."""


def stated(record: NodeRecord) -> Iterator[tuple[str, Interface | Parameter, str]]:
    """Yield the ends and parameters of a node, each with its relation and its IRI."""
    yield from ((end.role.relation, end, iri) for end, iri in record.ends.items())
    yield from ((_PARAMETER, parameter, iri) for parameter, iri in record.settable.items())


class Facts:
    """The facts of a store by relation."""

    def __init__(self, snapshot: EmbeddedSnapshot) -> None:
        self._snapshot = snapshot
        self._records = {one.iri: one for one in node_records(columns_of(snapshot))}
        self._parts: dict[tuple[str, str], Interface | Parameter] = {}
        pairs: defaultdict[str, set[tuple[str, str]]] = defaultdict(set)
        for node, record in self._records.items():
            for relation, part, iri in stated(record):
                if not part.implicit:
                    self._parts[node, iri] = part
                    pairs[relation].add((node, iri))
        for relation, term in INFERRED.items():
            pairs[relation].update((node, what) for node, what in rows(snapshot, _RULED % term, union=True))
        self.listed = {relation: sorted(pairs[relation]) for relation in RELATIONS if pairs[relation]}
        """For each relation, sorted pairs of IRIs: the node and the object."""

    def fact(self, relation: str, pair: tuple[str, str]) -> Fact:
        """Return the details of a listed fact."""
        node, thing = pair
        record, part = self._records[node], self._parts.get(pair)
        if part is None:
            labels = rows(self._snapshot, f"SELECT ?label {{ <{thing}> rdfs:label ?label }}", union=True)
            value, kind, written = min((row[0] for row in labels), default=thing), None, None
        else:
            value, kind = part.name, part.type
            written = part.written if isinstance(part, Interface) else None
        place = record.node.location if part is None else part.location
        return Fact(
            relation,
            record.repository,
            record.package,
            record.node.name,
            value,
            kind,
            written,
            place.repository or record.repository,
            place.path,
            place.line,
            part.via[-1] if part and part.via else None,
        )


class SourceLines:
    """The files of the sources of a store."""

    def __init__(self, sources: Iterable[SourceState]) -> None:
        self.states = {one.name: one for one in sources}
        self._lines = Lines({name: one.root for name, one in self.states.items() if one.root})

    def root(self, repository: str) -> Path | None:
        """Return the folder of a source on this machine; None without one."""
        state = self.states.get(repository)
        root = Path(state.root) if state and state.root else None
        return root if root and root.is_dir() else None

    def lines(self, repository: str, path: str) -> Sequence[str]:
        """Return the lines of a file of a source; none if it is missing."""
        return self._lines.of(repository, path)

    def text(self, repository: str, path: str, line: int) -> str | None:
        """Return one line without surrounding whitespace; None if it does not exist."""
        lines = self.lines(repository, path)
        return lines[line - 1].strip() if 0 < line <= len(lines) else None

    def address(self, repository: str, path: str, line: int) -> str:
        """Return the address of a line: the page of its commit, else the file."""
        state = self.states.get(repository)
        if state is None:
            return f"{path}:{line}"
        return state.page(path, line) or f"{Path(state.root or '') / path}:{line}"


COLUMNS: Final = (
    "number",
    "relation",
    "facts",
    "package",
    "node",
    "value",
    "type",
    "address",
    "source",
    "right",
    "remark",
)
_ANSWERS: Final = {
    "yes": "right",
    "y": "right",
    "no": "wrong",
    "n": "wrong",
    "unsure": "unsure",
    "?": "unsure",
    "": "not judged",
}
_HINT: Final = "Write yes, no or unsure into the column `right`, or leave it empty."


def drawn(facts: Facts, relations: Sequence[str], size: int, seed: int) -> list[tuple[str, tuple[str, str]]]:
    """Return a stratified random sample, deterministic for the same store and seed."""
    chance = random.Random(seed)  # noqa: S311 - no secret
    listed = {relation: facts.listed[relation] for relation in relations if relation in facts.listed}
    rows = shares_of({relation: len(pairs) for relation, pairs in listed.items()}, size)
    return [(relation, pair) for relation, pairs in listed.items() for pair in chance.sample(pairs, rows[relation])]


def as_sheet(facts: Facts, sample: Sequence[tuple[str, tuple[str, str]]], lines: SourceLines) -> str:
    """Return a sample as CSV, each fact with the text of its line and its address."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    for number, (relation, pair) in enumerate(sample, 1):
        fact = facts.fact(relation, pair)
        place = fact.file_repository, fact.path, fact.line
        cells = (fact.package, fact.node, fact.value, fact.type, lines.address(*place), lines.text(*place))
        words = [safe_cell(cell or "") for cell in cells]
        writer.writerow([number, relation, len(facts.listed[relation]), *words, "", ""])
    return out.getvalue()


def score_sheet(path: Path) -> Table:
    """Return the precision of each relation in a judged sheet, with Wilson intervals.

    Unsure and unjudged facts do not count. The last row weighs relations by their number of facts (stratified estimate,
    Cochran 1977, section 5.6).

    Raises UsageError: KG722 an invalid sheet or answer, with its line.
    """
    answers: defaultdict[str, Counter[str]] = defaultdict(Counter)
    sizes: dict[str, int] = {}
    for line, row in _rows(path):
        answer = (row["right"] or "").strip().lower()
        if answer not in _ANSWERS:
            raise UsageError("KG722", f"`{answer}` is not an answer", place=Place(str(path), line), hint=_HINT)
        facts = row["facts"] or ""
        if not facts.isdecimal() or len(facts) > 12:  # noqa: PLR2004 - more facts than any store has
            raise UsageError("KG722", f"`{facts}` is not a number of facts", place=Place(str(path), line))
        relation = row["relation"] or ""
        sizes[relation] = int(facts)
        answers[relation][_ANSWERS[answer]] += 1
    judged = {relation: given["right"] + given["wrong"] for relation, given in answers.items()}
    rows: list[tuple[Cell, ...]] = [
        (relation, share(given["right"], judged[relation]), given["unsure"], given["not judged"], sizes[relation])
        for relation, given in answers.items()
    ]
    every = weighed((sizes[relation], judged[relation], given["right"]) for relation, given in answers.items())
    rows.append(("all, weighed by facts", every, None, None, None))
    return Table(
        "sample",
        "Sampled facts that a person judged right",
        ("relation", "precision", "unsure", "not judged", "facts"),
        tuple(rows),
        (f"{count(sum(judged.values()), 'fact')} judged.",),
    )


def _rows(path: Path) -> Iterator[tuple[int, dict[str, str | None]]]:
    try:
        text = path.read_text("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UsageError("KG722", f"the sheet cannot be read: {reason}", place=Place(str(path))) from None
    reader = csv.DictReader(io.StringIO(text))
    needed = ("relation", "facts", "right")
    try:
        missing = [name for name in needed if name not in (reader.fieldnames or ())]
        if missing:
            message = f"the sheet has no column `{missing[0]}`"
            raise UsageError("KG722", message, place=Place(str(path), 1), hint="`kg eval sample` writes sheets.")
        for row in reader:
            yield reader.line_num, row
    except csv.Error as error:
        raise UsageError("KG722", f"invalid CSV: {error}", place=Place(str(path), reader.line_num)) from None
