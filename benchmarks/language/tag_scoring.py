"""How well and how fast a pipeline tags, on given tokens and from raw text."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from spacy.tokens import Doc
from treebank import reference

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from spacy.language import Language
    from spacy.tokens import Token
    from treebank import Sentence

__all__ = ["Scores", "score", "speed"]


@dataclass(frozen=True, slots=True)
class Scores:
    """Shares of one: on the tokens of the reference, and from raw text.

    From raw text a token counts when both its place and its tag are right: `raw_*` are F1 over both, `aligned_tag` is
    the accuracy on the tokens whose place is right. Parts of speech and lemmas are None where the reference has none.
    """

    sentences: int
    tokens: int
    tag: float
    part: float | None
    lemma: float | None
    raw_token: float
    raw_tag: float
    aligned_tag: float


def score(nlp: Language, sentences: Sequence[Sentence]) -> Scores:
    """Compare a pipeline with tagged sentences."""
    gold = [reference(nlp.vocab, sentence) for sentence in sentences]
    given = [Doc(nlp.vocab, words=list(one.words), spaces=list(one.spaces)) for one in sentences]
    tagged = list(nlp.pipe(given))
    raw = list(nlp.pipe([doc.text for doc in gold]))
    tokens = sum(map(len, gold))

    def share(of: Callable[[Token], str]) -> float:
        pairs = (pair for one, other in zip(gold, tagged, strict=True) for pair in zip(one, other, strict=True))
        return sum(of(one) == of(other) for one, other in pairs) / tokens

    places = _f1(gold, raw, lambda _: "")
    tags = _f1(gold, raw, lambda token: token.tag_)
    return Scores(
        len(gold),
        tokens,
        share(lambda token: token.tag_),
        share(lambda token: token.pos_) if sentences[0].parts else None,
        share(lambda token: token.lemma_.lower()) if sentences[0].lemmas else None,
        places[0],
        tags[0],
        tags[1] / places[1],
    )


def _f1(gold: list[Doc], found: list[Doc], of: Callable[[Token], str]) -> tuple[float, int]:
    """Return F1 over places and what `of` tells, and how many are right."""
    right = wanted = given = 0
    for one, other in zip(gold, found, strict=True):
        theirs = {(token.idx, len(token), of(token)) for token in one}
        ours = {(token.idx, len(token), of(token)) for token in other if not token.is_space}
        right += len(theirs & ours)
        wanted += len(theirs)
        given += len(ours)
    return 2 * right / (wanted + given), right


def speed(nlp: Language, texts: Sequence[str], repeat: int = 3) -> float:
    """Return sentences a second of processor time, the best of some runs; the first text is there to warm up."""
    list(nlp.pipe(texts[:1]))
    best = 0.0
    for _ in range(repeat):
        began = time.process_time()
        list(nlp.pipe(texts, batch_size=256))
        best = max(best, len(texts) / (time.process_time() - began))
    return best
