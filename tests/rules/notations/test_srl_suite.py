from __future__ import annotations

import os
from pathlib import Path

import pytest
from rules.notations.srl_suite import Entry, entries, failure

FOLDER = os.environ.get("KG_SRL_SUITE", "")
REFUSED = {
    "syntax-ruleset-structure-08.srl": "IF ... FOR ... THEN is of a former draft; the grammar has no such production",
}
"""Tests that contradict the grammar, with the reason."""


def chosen() -> list[Entry]:
    """Return the tests of the suite, except those whose files are missing."""
    return [entry for entry in entries(Path(FOLDER)) if not entry.missing] if FOLDER else []


@pytest.mark.skipif(not FOLDER, reason="KG_SRL_SUITE does not name a folder of the W3C's tests of SPARQL RL")
def test_the_suite_is_found() -> None:
    """The given folder has tests of each kind."""
    assert {entry.kind for entry in chosen()} == {"Syntax", "WellFormedness", "Stratification", "Eval"}


@pytest.mark.parametrize("entry", chosen(), ids=lambda entry: entry.name)
def test_the_suite_passes(entry: Entry) -> None:
    """Each test of the W3C's suite passes."""
    why = failure(entry)
    if why is not None and entry.rules.name in REFUSED:
        pytest.skip(REFUSED[entry.rules.name])
    assert why is None
