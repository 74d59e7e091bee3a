"""Sheets of sampled facts: drawn from the example workspace, judged, and scored."""

from __future__ import annotations

import csv
import io
from contextlib import suppress
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.errors import UsageError
from kg.evaluate.sheet import COLUMNS, INFERRED, RELATIONS, Facts, SourceLines, as_sheet, drawn, score_sheet
from kg.evaluate.tables import Score, Share, shares_of
from kg.graph.source_states import sources

if TYPE_CHECKING:
    from pathlib import Path

    from evaluate.conftest import Field


def sheet(field: Field, size: int, seed: int = 0) -> list[dict[str, str]]:
    """Return the rows of a sheet of the example workspace."""
    with field.store.read() as snapshot:
        facts = Facts(snapshot)
        text = as_sheet(facts, drawn(facts, RELATIONS, size, seed), SourceLines(sources(snapshot)))
    return list(csv.DictReader(io.StringIO(text)))


def test_a_sheet_has_facts_of_every_relation_with_their_lines(field: Field) -> None:
    """Asserted facts have the line of their origin; inferred ones that of their node."""
    rows = sheet(field, 50)
    assert len(rows) == 50
    assert {row["relation"] for row in rows} >= {"publishes", "has parameter", "calls action", *INFERRED}
    named = [row for row in rows if row["relation"] in {"provides", "serves action"} and row["value"]]
    assert any(row["value"].split("/")[-1] in row["source"] for row in named)
    assert all(row["address"].partition(":")[0].startswith(str(field.source)) for row in rows)
    assert sheet(field, 50) == rows
    assert sheet(field, 50, 1) != rows


def test_a_sheet_larger_than_the_store_has_every_fact(field: Field) -> None:
    """Each fact is drawn once."""
    rows = sheet(field, 100_000)
    with field.store.read() as snapshot:
        assert len(rows) == sum(map(len, Facts(snapshot).listed.values()))


@given(st.dictionaries(st.text(max_size=3), st.integers(0, 40), max_size=6), st.integers(0, 150))
def test_strata_get_the_same_as_far_as_they_can(sizes: dict[str, int], size: int) -> None:
    """No stratum gets more than its size, and none less than another unless exhausted."""
    found = shares_of(sizes, size)
    assert sum(found.values()) == min(size, sum(sizes.values()))
    most = max(found.values(), default=0)
    assert all(
        number <= sizes[name] and (number >= most - 1 or number == sizes[name]) for name, number in found.items()
    )


def judged(path: Path, rows: list[tuple[str, int, str]]) -> Path:
    """Write a sheet with relations, numbers of facts and answers."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for relation, facts, answer in rows:
            writer.writerow({"relation": relation, "facts": facts, "right": answer, "source": 'a "line",\nof two'})
    return path


def test_a_judged_sheet_is_scored(tmp_path: Path) -> None:
    """Unsure and empty answers are ignored; the last row weights relations by their facts."""
    rows = [("publishes", 90, "yes"), ("publishes", 90, " Y "), ("publishes", 90, "?"), ("publishes", 90, "")]
    rows += [("provides", 10, "yes"), ("provides", 10, "NO")]
    table = score_sheet(judged(tmp_path / "sheet.csv", rows))
    publishes, provides, every = table.rows
    assert isinstance(publishes[1], Share)
    assert (publishes[1].part, publishes[1].whole, publishes[2:]) == (2, 2, (1, 1, 90))
    assert isinstance(provides[1], Share)
    assert provides[1].value == 0.5
    assert isinstance(every[1], Score)
    assert every[1].value == pytest.approx(0.95)
    assert every[1].interval[0] < 0.95 < every[1].interval[1] <= 1


def test_relations_that_were_not_judged_leave_the_whole_open(tmp_path: Path) -> None:
    """Without judgements of a relation the total is open."""
    table = score_sheet(judged(tmp_path / "sheet.csv", [("publishes", 9, "yes"), ("calls", 9, "")]))
    assert table.rows[-1][1] is None


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("relation,facts,right\na,1,yes\na,1,maybe\n", 3, "`maybe` is not an answer"),
        ("relation,facts,right\na,some,yes\n", 2, "not a number of facts"),
        ("relation,facts\na,1\n", 1, "no column `right`"),
        ("", 1, "no column"),
    ],
)
def test_what_is_no_sheet_is_refused(tmp_path: Path, text: str, line: int, words: str) -> None:
    """The error has the line."""
    path = tmp_path / "sheet.csv"
    path.write_text(text)
    with pytest.raises(UsageError, match=words) as raised:
        score_sheet(path)
    assert raised.value.code == "KG722"
    assert raised.value.place is not None
    assert raised.value.place.line == line


def test_a_sheet_that_is_not_there_is_refused(tmp_path: Path) -> None:
    """A missing file is KG722."""
    with pytest.raises(UsageError, match="cannot be read"):
        score_sheet(tmp_path / "none.csv")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.text(alphabet=',"\n\r\x00yesno?1 relation', max_size=120))
def test_any_text_is_scored_or_refused(tmp_path: Path, text: str) -> None:
    """Any text is scored or rejected."""
    path = tmp_path / "any.csv"
    path.write_text(f"relation,facts,right\n{text}")
    with suppress(UsageError):
        score_sheet(path)


def test_no_cell_is_a_formula(field: Field, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line of code that begins as a formula of a spreadsheet is quoted."""
    monkeypatch.setattr(SourceLines, "text", lambda *_: "=HYPERLINK(1)")
    assert {row["source"] for row in sheet(field, 10)} == {"'=HYPERLINK(1)"}


def test_paths_that_lead_out_of_a_source_are_not_read(field: Field) -> None:
    """For a foreign store, only files of its sources are read, and no address fails."""
    with field.store.read() as snapshot:
        lines = SourceLines(sources(snapshot))
        (name,) = lines.states
        assert lines.text(name, "README.md", 1)
        assert lines.text(name, "README.md", 10_000) is None
        assert lines.text(name, "../store/current", 1) is None
        assert lines.text("nowhere", "README.md", 1) is None
        assert lines.address("nowhere", "a.cpp", 3) == "a.cpp:3"
