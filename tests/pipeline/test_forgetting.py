"""Tests of removing sources from a store."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import SourceError
from kg.pipeline.build import build
from kg.pipeline.forgetting import forget
from kg.settings import load

if TYPE_CHECKING:
    from pathlib import Path

    from pipeline.conftest import Bench


def test_a_forgotten_source_stays_out(bench: Bench, tmp_path: Path) -> None:
    """A removed source leaves the graph, and a build without names does not bring it back."""
    other = type(bench)(tmp_path / "other", bench.store)
    other.package("three", "third")
    bench.build()
    other.build()
    forget(bench.store, load({}, environment={}), ["local/src"])
    assert "/talk" not in bench.topics()
    report = build([], bench.store, load({}, environment={}))
    assert [source.repository.name for source in report.sources] == ["local/other"]
    assert (report.read, report.generation) == (0, None)


def test_the_last_source(bench: Bench) -> None:
    """After removing all sources there is nothing to build; building them by name brings them back."""
    bench.build()
    forget(bench.store, load({}, environment={}), ["local/src"])
    with pytest.raises(SourceError):
        build([], bench.store, load({}, environment={}))
    assert bench.build().read == 3
    assert "/talk" in bench.topics()
