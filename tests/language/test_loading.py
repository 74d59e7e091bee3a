from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import spacy

from kg.errors import UsageError
from kg.facts.places import Location
from kg.facts.texts import Description, DescriptionKind
from kg.language.annotating import annotate, prepare
from kg.language.loading import SHIPPED, describe, identity, pipeline

if TYPE_CHECKING:
    from pathlib import Path


def with_rules(folder: Path, *, lemmas: bool = True) -> str:
    """Write a pipeline that sets parts of speech, and optionally lemmas, without Penn tags; return its path."""
    nlp = spacy.blank("en")
    rules = nlp.add_pipe("attribute_ruler")
    add = getattr(rules, "add")  # noqa: B009 - the factory's type is not known here
    add([[{"LOWER": "cameras"}]], {"POS": "NOUN", **({"LEMMA": "camera"} if lemmas else {})})
    add([[{"LOWER": {"NOT_IN": ["cameras"]}}]], {"POS": "X", **({"LEMMA": "other"} if lemmas else {})})
    nlp.to_disk(folder)
    return str(folder)


def test_a_pipeline_of_the_user_tags_instead(tmp_path: Path) -> None:
    """Universal parts of speech and lemmas are enough."""
    model = with_rules(tmp_path / "own")
    (found,) = annotate([Description("It reads two cameras", DescriptionKind.WIKI, Location("a", 1))], model)
    assert found.words == ("camera",)
    assert [phrase.text for phrase in found.phrases] == ["camera"]


@pytest.mark.parametrize("model", ["no_such_pipeline", "/no/such/folder", "./nowhere", "kg", "a b"])
def test_a_pipeline_that_is_not_there_is_told(model: str) -> None:
    """The error has instructions."""
    with pytest.raises(UsageError) as caught:
        prepare(model)
    assert caught.value.code == "KG141"
    assert caught.value.hint


def test_a_folder_that_is_no_pipeline_is_told(tmp_path: Path) -> None:
    """An invalid configuration is not a defect."""
    (tmp_path / "meta.json").write_text("{}", encoding="utf-8")
    (tmp_path / "config.cfg").write_text("[nlp", encoding="utf-8")
    with pytest.raises(UsageError) as caught:
        prepare(str(tmp_path))
    assert caught.value.code == "KG141"


def test_a_pipeline_without_lemmas_is_refused(tmp_path: Path) -> None:
    """The error names the missing attribute."""
    with pytest.raises(UsageError, match="no lemmas") as caught:
        prepare(with_rules(tmp_path / "own", lemmas=False))
    assert caught.value.code == "KG142"


def test_the_identity_tells_pipelines_apart(tmp_path: Path) -> None:
    """Another pipeline, or another state of one, has another identity; the same one has the same."""
    model = with_rules(tmp_path / "own")
    before = identity(model)
    assert before == identity(model) != identity("")
    with_rules(tmp_path / "own", lemmas=False)
    assert identity(model) != before
    assert identity("spacy") != "spacy"
    assert identity("no_such_pipeline") == "no_such_pipeline"


def test_the_shipped_pipeline_is_described() -> None:
    """`kg doctor` names it with its version."""
    assert describe("") == "en_kg_ros 1.0.0 (shipped with kg)"
    assert describe("no_such_pipeline") == "no_such_pipeline"


def test_the_shipped_model_is_small_and_licensed() -> None:
    """It has a few megabytes, with the notice of the treebank's licence."""
    assert sum(path.stat().st_size for path in SHIPPED.rglob("*") if path.is_file()) <= 5_000_000
    assert "CC BY-SA 4.0" in (SHIPPED / "NOTICE").read_text("utf-8")


def test_the_shipped_pipeline_computes_in_single_precision() -> None:
    """Half precision is used on disk only."""
    model = getattr(pipeline("").get_pipe("tagger"), "model")  # noqa: B009 - parts of pipelines have no common type
    kinds = {
        str(node.get_param(name).dtype) for node in model.walk() for name in node.param_names if node.has_param(name)
    }
    assert kinds == {"float32"}
