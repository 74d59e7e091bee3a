from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from language import sentences

from kg.errors import UsageError
from kg.facts.places import Location
from kg.facts.texts import Description, DescriptionKind
from kg.language.annotating import annotate
from kg.language.loading import pipeline
from kg.language.patterns import PhraseFinder, read_patterns

if TYPE_CHECKING:
    from pathlib import Path

CASES = [line for line in (sentences.CASES / "phrases.txt").read_text("utf-8").splitlines() if line[:1] != "#"]


def phrases(text: str) -> list[tuple[str, str]]:
    """Return the phrases of a text with the patterns that found them."""
    (found,) = annotate([Description(text, DescriptionKind.README, Location("README.md", 1))])
    return [(phrase.text, phrase.pattern) for phrase in found.phrases]


def lemmas(text: str) -> str:
    """Return a phrase of the test's text in the form of phrases."""
    words = (token.lemma_ if token.pos_ in {"NOUN", "PROPN"} else token.text for token in pipeline("")(text))
    return " ".join(word.lower() for word in words if word != "-")


@pytest.mark.parametrize("pattern", read_patterns(), ids=lambda pattern: pattern.name)
def test_the_example_of_a_pattern_is_found_by_it(pattern: object) -> None:
    """The bracketed part of the example is found, and by this pattern."""
    text, wanted = sentences.bracketed(getattr(pattern, "example", ""))
    name = getattr(pattern, "name", "")
    assert [(found, by) for found, by in phrases(text) if by == name] == [(lemmas(one), name) for one in wanted]


@pytest.mark.parametrize("line", CASES)
def test_phrases_are_those_in_brackets(line: str) -> None:
    """Exactly the hardware nouns of a sentence are found."""
    text, wanted = sentences.bracketed(line)
    assert [found for found, _ in phrases(text)] == [lemmas(one) for one in wanted]


def test_phrases_are_written_as_in_the_dictionary() -> None:
    """Lower case, nouns in the singular, no separate hyphens."""
    assert [text for text, _ in phrases("It drives pan-tilt units and Charging Stations.")][:1] == ["pan tilt unit"]


def test_a_dash_parts_phrases() -> None:
    """A hyphen surrounded by spaces does not join words."""
    assert [text for text, _ in phrases("The Velodyne - camera calibration.")] == ["velodyne", "camera"]


@pytest.mark.parametrize(
    "text",
    [
        "not TOML",
        "",
        '[[pattern]]\nname = "a"\nexample = ""\ndocumentation = ""\nphrase = ["unknown"]',
        '[[pattern]]\nname = "a"\nexample = ""\ndocumentation = ""\nphrase = ["two words"]',
        '[[pattern]]\nname = "a"\nexample = ""\ndocumentation = ""\nphrase = [{ LEMMA = { IN = "@none" } }]',
    ],
)
def test_patterns_that_cannot_be_read_are_refused(text: str, tmp_path: Path) -> None:
    """The error names the file."""
    file = tmp_path / "patterns.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(UsageError) as caught:
        read_patterns(file)
    assert caught.value.code == "KG143"
    assert caught.value.place is not None


def test_patterns_that_spacy_refuses_are_refused(tmp_path: Path) -> None:
    """The error names the pattern."""
    file = tmp_path / "patterns.toml"
    file.write_text('[[pattern]]\nname = "odd"\nexample = ""\ndocumentation = ""\nphrase = [{ NOTHING = 1 }]', "utf-8")
    with pytest.raises(UsageError, match="odd") as caught:
        PhraseFinder(pipeline("").vocab, read_patterns(file))
    assert caught.value.code == "KG143"
