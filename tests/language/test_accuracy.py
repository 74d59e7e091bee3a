from __future__ import annotations

from pathlib import Path

from language import sentences
from spacy.tokens import Doc

from kg.language.loading import pipeline

TRAINING = Path(__file__).resolve().parents[2] / "benchmarks" / "language" / "ros-sentences.txt"


def test_sentences_about_robots_are_tagged_as_by_hand() -> None:
    """At least 95 of 100 Penn tags equal those given by hand in advance."""
    nlp = pipeline("")
    gold = sentences.tagged("ros-sentences.txt")
    docs = nlp.pipe(Doc(nlp.vocab, words=[word for word, _ in sentence]) for sentence in gold)
    pairs = [
        (token.tag_, tag)
        for doc, sentence in zip(docs, gold, strict=True)
        for token, (_, tag) in zip(doc, sentence, strict=True)
    ]
    assert len(gold) == 100
    assert sum(found == tag for found, tag in pairs) / len(pairs) >= 0.95


def test_no_sentence_of_the_tests_was_trained_on() -> None:
    """The evaluation sentences are not part of the training data."""
    wanted = set((sentences.CASES / "ros-sentences.txt").read_text("utf-8").splitlines())
    assert not wanted & set(TRAINING.read_text("utf-8").splitlines())
