from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from kg.errors import UsageError
from kg.language import annotating
from kg.pipeline.build import build
from kg.pipeline.estimating import pending
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

MANIFEST = """<package format="2"><name>eyes</name><version>1.0.0</version>
<description>Publishes the images of a Basler camera that looks at the ground.</description>
<maintainer email="a@example.org">A</maintainer><license>MIT</license></package>
"""


def phrases(store: EmbeddedStore) -> list[str]:
    """Return the texts of all phrases in the store."""
    query = """PREFIX rnkg: <https://w3id.org/rnkg/ns#>
    SELECT DISTINCT ?text { ?description rnkg:hasPhrase/rnkg:text ?text } ORDER BY ?text"""
    with store.read() as snapshot:
        rows: Any = snapshot.query(query)
        return [str(row["text"].value) for row in rows]


def test_a_build_stores_the_phrases_of_descriptions(tmp_path: Path) -> None:
    """The description of a manifest is tagged with the shipped pipeline."""
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "package.xml").write_text(MANIFEST, encoding="utf-8")
    store = EmbeddedStore.create(tmp_path / "store")
    build([str(tmp_path / "src")], store, load({}, environment={}, folder=tmp_path), rules=False)
    assert phrases(store) == ["basler camera"]


def test_what_was_tagged_before_is_not_tagged_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package with other changes keeps the phrases of its texts, and spaCy is not even loaded."""
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "package.xml").write_text(MANIFEST, encoding="utf-8")
    store = EmbeddedStore.create(tmp_path / "store")
    settings = load({"jobs": 2}, environment={}, folder=tmp_path)
    build([str(tmp_path / "src")], store, settings, rules=False)
    (tmp_path / "src" / "package.xml").write_text(MANIFEST.replace("1.0.0", "1.0.1"), encoding="utf-8")

    def refuse(_model: str) -> None:
        raise AssertionError("spaCy was loaded")

    monkeypatch.setattr(annotating, "pipeline", refuse)
    report = build([str(tmp_path / "src")], store, settings, rules=False)
    assert not [problem for source in report.sources for one in source.packages for problem in one.problems]
    assert phrases(store) == ["basler camera"]


def test_a_pipeline_that_cannot_be_loaded_ends_the_build(tmp_path: Path) -> None:
    """It ends before anything is read, and the store is unchanged."""
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "package.xml").write_text(MANIFEST, encoding="utf-8")
    store = EmbeddedStore.create(tmp_path / "store")
    settings = load({"nlp_model": "no_such_pipeline"}, environment={}, folder=tmp_path)
    with pytest.raises(UsageError) as caught:
        build([str(tmp_path / "src")], store, settings, rules=False)
    assert caught.value.code == "KG141"
    assert store.layout.current() is None


def test_another_pipeline_reads_everything_again(tmp_path: Path) -> None:
    """A build with another pipeline would read each package again, one with the same pipeline none."""
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "package.xml").write_text(MANIFEST, encoding="utf-8")
    store = EmbeddedStore.create(tmp_path / "store")
    settings = load({}, environment={}, folder=tmp_path)
    build([str(tmp_path / "src")], store, settings, rules=False)
    assert not any(pending(store.layout, settings).values())
    other = load({"nlp_model": "another_pipeline"}, environment={}, folder=tmp_path)
    assert list(pending(store.layout, other).values()) == [("eyes",)]


def test_paths_of_pipelines_are_relative_to_the_settings(tmp_path: Path) -> None:
    """A name is unchanged, a path is relative to the folder of kg.toml."""
    (tmp_path / "kg.toml").write_text('nlp_model = "./models/own"\n', encoding="utf-8")
    assert load({}, environment={}, folder=tmp_path).nlp_model == str(tmp_path / "models" / "own")
    assert load({"nlp_model": "en_core_web_sm"}, environment={}, folder=tmp_path).nlp_model == "en_core_web_sm"
