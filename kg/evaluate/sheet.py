"""A sheet of sampled facts for a person to judge, and the precision in a judged sheet.

The sample is stratified: every relation gets the same number of rows, as far as it has facts. So a sheet gives the
precision of each relation, and that of all facts by weighing relations by their size.
"""

from __future__ import annotations

import csv
import io
import random
from collections import Counter, defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import Place, UsageError
from kg.evaluate.completeness import share
from kg.evaluate.intervals import shares_of, weighed
from kg.evaluate.tables import Cell, Table, safe_cell
from kg.lint.lines import Lines
from kg.render.text import count

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.evaluate.facts import Facts
    from kg.graph.source_states import SourceState


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
