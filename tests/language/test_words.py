from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.language.embedding import FEATURES, features
from kg.language.lemmas import Lemmas, lemma
from kg.language.loading import pipeline


@pytest.mark.parametrize(
    "text",
    [
        "sensor_msgs/LaserScan",
        "/camera/image_raw",
        "~frame_id",
        "base_link",
        "std::vector",
        "UTM-30LX",
        "VLP-16",
        "demo.launch.py",
        "config.yaml",
        "/dev/ttyUSB0",
        "rad/s",
        "C++",
        "cmd_vel",
    ],
)
@pytest.mark.parametrize("around", ["{}", "({})", "{},", "{}.", "`{}`", '"{}"', "see {}:"])
def test_identifiers_are_one_word(text: str, around: str) -> None:
    """An identifier is not split, whatever the characters around it."""
    assert text in [token.text for token in pipeline("").make_doc(around.format(text))]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("user-friendly", ["user", "-", "friendly"]),
        ("publisher/subscriber", ["publisher", "/", "subscriber"]),
        ("and/or", ["and", "/", "or"]),
        ("Stop!!!", ["Stop", "!!!"]),
        ("-----", ["-----"]),
        ("run()", ["run", "(", ")"]),
    ],
)
def test_what_is_no_identifier_is_split(text: str, words: list[str]) -> None:
    """Compounds and punctuation are split as in the treebank."""
    assert [token.text for token in pipeline("").make_doc(text)] == words


@given(st.text())
def test_tokens_make_the_text(text: str) -> None:
    """The tokenizer preserves the whole text."""
    assert pipeline("").make_doc(text).text == text


@pytest.mark.parametrize(
    ("word", "tag", "wanted"),
    [
        ("Publishes", "VBZ", "publish"),
        ("fuses", "VBZ", "fuse"),
        ("scanning", "VBG", "scan"),
        ("moving", "VBG", "move"),
        ("lidars", "NNS", "lidar"),
        ("batteries", "NNS", "battery"),
        ("axes", "NNS", "axis"),
        ("kinematics", "NNS", "kinematics"),
        ("mapped", "VBN", "map"),
        ("went", "VBD", "go"),
        ("smaller", "JJR", "small"),
        ("chassis", "NN", "chassis"),
        ("UTM-30LXs", "NNS", "utm-30lxs"),
        ("Kinect", "NNP", "kinect"),
    ],
)
def test_lemmas_are_those_of_the_dictionary(word: str, tag: str, wanted: str) -> None:
    """Lemmas come from the list of exceptions or the suffix rules of the tag."""
    lemmas = pipeline("").get_pipe("kg_lemmas")
    assert isinstance(lemmas, Lemmas)
    assert lemma(word, tag, lemmas.exceptions, lemmas.endings) == wanted


@given(st.text(), st.sampled_from(("NNS", "VBZ", "VBG", "NN", "JJR", "")))
def test_no_lemma_is_empty(word: str, tag: str) -> None:
    """A word with letters has a lemma in lower case."""
    lemmas = pipeline("").get_pipe("kg_lemmas")
    assert isinstance(lemmas, Lemmas)
    found = lemma(word, tag, lemmas.exceptions, lemmas.endings)
    assert found == found.lower()
    assert bool(found) == bool(word)


@given(st.text())
def test_every_word_has_all_features(word: str) -> None:
    """The embedding has a row for each feature, however unusual the word."""
    assert len(features(word)) == len(FEATURES)
