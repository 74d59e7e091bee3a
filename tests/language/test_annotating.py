from __future__ import annotations

import subprocess
import sys
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import patient

from kg.facts.places import Location
from kg.facts.texts import Description, DescriptionKind
from kg.language.annotating import LONGEST_TEXT, STOP_WORDS, annotate, sentences

SOME_WORDS = (
    "robot",
    "Publishes",
    "the",
    "laser",
    "scan",
    "of",
    "a",
    "Kinect",
    "2",
    "-",
    "/scan",
    "base_link",
    ".",
    "{",
    "\n\n",
)
TEXTS = st.one_of(st.text(), st.lists(st.sampled_from(SOME_WORDS)).map(" ".join))
HOSTILE = {
    "a word of 100,000 characters": "x" * 100_000,
    "words of 100 characters": " ".join("ab" * 50 for _ in range(5000)),
    "one noun, 20,000 times": "camera " * 20_000,
    "proper nouns without end": "Velodyne VLP-16 " * 20_000,
    "hyphens": "-" * 50_000,
    "hyphens between nouns": "laser-" * 20_000,
    "full stops": "." * 100_000,
    "slashes": "/a" * 50_000,
    "an identifier without end": "a_" * 50_000,
    "colons": "a::" * 50_000,
    "numbers": "1.2.3-4 " * 20_000,
    "code": "for (int i = 0; i < n; ++i) { a[i] = b[i] * c[i]; } " * 500,
    "control characters": "The \x00\x01\x1b[31mcamera\x07 \u202e moves. " * 500,
    "half of a pair": "a camera \ud800 moves \udfff here",
    "Chinese": "这个节点发布激光扫描仪的数据。" * 2000,
    "Russian": "Этот узел публикует данные лазерного сканера. " * 500,
    "pictures": "\U0001f916\U0001f4f7" * 20_000,
    "no-break spaces": "a\u00a0camera\u00a0" * 20_000,
    "brackets": "(" * 50_000 + ")" * 50_000,
    "quotes": "'\"`" * 30_000,
    "newlines": "\n" * 100_000,
    "addresses": "https://example.org/" + "a/" * 50_000,
    "mail": "a@" * 50_000,
}


def described(text: str) -> Description:
    """Return a description of this text."""
    return Description(text, DescriptionKind.COMMENT, Location("src/node.cpp", 1), heading="Usage")


def test_words_are_lemmas_of_the_classes_that_carry_meaning() -> None:
    """Nouns, names, verbs and adjectives; no numbers, identifiers or light verbs."""
    (found,) = annotate([described("This node has merged 2 small scans of /front and uses base_link.")])
    assert found.words == ("merge", "node", "scan", "small")


def test_descriptions_keep_their_order_and_the_rest() -> None:
    """Only words and phrases are added."""
    given_texts = ["It reads a camera.", "", "It moves an arm.", "It reads a camera."]
    found = annotate([described(text) for text in given_texts])
    assert [one.text for one in found] == given_texts
    assert found[0] == found[3]
    assert found[1] == described("")
    assert [phrase.text for one in found for phrase in one.phrases] == ["camera", "arm", "camera"]


def test_usage_is_left_alone() -> None:
    """Usage has no words, and its text no effect on a description with the same one."""
    text = "It reads a camera."
    usage = Description(text, DescriptionKind.USAGE, Location("README.md", 9))
    assert annotate([usage, described(text)], known={text: usage}) == (usage, *annotate([described(text)]))


@settings(max_examples=60, deadline=None)
@given(st.lists(TEXTS, max_size=4))
def test_annotating_is_a_pure_function_of_each_text(texts: list[str]) -> None:
    """A text gives the same result in any context; words are sorted, in lower case, each once."""
    together = annotate([described(text) for text in texts])
    assert together == tuple(annotate([described(text)])[0] for text in texts)
    assert together == annotate(together)
    for one in together:
        assert list(one.words) == sorted(set(one.words))
        assert all(word == word.lower() and word not in STOP_WORDS for word in one.words)
        assert len(set(one.phrases)) == len(one.phrases)
        assert all(phrase.text == " ".join(phrase.text.split()) for phrase in one.phrases)


@given(st.text())
def test_sentences_hold_nothing_but_words_of_the_text(text: str) -> None:
    """No word is invented, and none is longer than the text."""
    assert sum(map(len, sentences(text))) <= len(text) + 1
    assert set("".join(sentences(text))) <= set(text) | {" "}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
def test_hostile_texts_are_tagged_in_bounded_time(text: str) -> None:
    """Any text is tagged quickly without ending the process, and the result is bounded by the examined part."""
    annotate([described("A camera.")])
    began = time.process_time()
    (found,) = annotate([described(text)])
    assert time.process_time() - began < 10
    assert sum(len(phrase.text) for phrase in found.phrases) <= LONGEST_TEXT


def test_texts_that_are_no_language_are_left_alone() -> None:
    """Code, other scripts and data give no words."""
    for name in ("Chinese", "Russian", "code", "full stops", "a word of 100,000 characters"):
        (found,) = annotate([described(HOSTILE[name])])
        assert (found.words, found.phrases) == ((), ()), name


def test_nothing_to_tag_loads_nothing() -> None:
    """Packages without descriptions, or with empty ones, do not load spaCy."""
    code = (
        "import sys; from kg.language.annotating import annotate; from kg.language.loading import identity;"
        "from kg.facts.texts import *;"
        "from kg.facts.places import Location; import kg.pipeline.work;"
        "annotate([]); annotate([Description('', DescriptionKind.WIKI, Location('a', 1))]); identity('');"
        "assert 'spacy' not in sys.modules and 'thinc' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=patient(30))


@given(TEXTS)
@settings(max_examples=25, deadline=None)
def test_what_is_known_is_taken_over(text: str) -> None:
    """A text annotated before gets the same words and phrases again, wherever it is now."""
    place = Location("README.md", 1)
    (before,) = annotate([Description(text, DescriptionKind.README, place)])
    moved = Description(text, DescriptionKind.COMMENT, Location("a.cpp", 7), "driver")
    assert annotate([moved], known={text: before}) == annotate([moved])
