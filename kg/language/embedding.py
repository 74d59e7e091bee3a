"""Embedding of words in the shipped model, from their form and their first and last characters.

Most words of robotics are missing from treebanks. Their endings show their part of speech (`-izer`, `-ing`, `_msgs`).
So the embedding uses more of the ending than spaCy's, whose features are the norm, a prefix of one character and a
suffix of three.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from spacy.strings import hash_string  # type: ignore[attr-defined]  # missing in its stub
from spacy.util import registry
from thinc.api import HashEmbed, Maxout, Model, chain, concatenate, list2ragged, ragged2list, with_array

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from spacy.tokens import Doc

FEATURES: Final = ("form", "shape", "prefix", "suffix2", "suffix3", "suffix4")
"""Features of a word, each with its own table."""

_KEPT_WORDS: Final = 100_000  # number of words with cached features; only malicious texts have more different ones
_LONGEST_FORM: Final = 64
_RUN: Final = 4  # longest run of the same kind of character in a shape, as in spaCy
_DIGIT: Final = re.compile(r"\d")


def features(word: str) -> tuple[str, ...]:
    """Return the features of a word, in the order of `FEATURES`."""
    word = word[:_LONGEST_FORM]
    lower = _DIGIT.sub("0", word.lower())
    return lower, _shape(word), lower[:3], lower[-2:], lower[-3:], lower[-4:]


def affix_embed(width: int, rows: Sequence[int]) -> Model[Any, Any]:
    """Return a layer from documents to vectors of `width`, with `rows` of a hash table for each of `FEATURES`."""
    tables: list[Model[Any, Any]] = [
        HashEmbed(width, row, column=column, seed=column + 1, dropout=0.0) for column, row in enumerate(rows)
    ]
    mix = Maxout(width, width * len(tables), nP=3, dropout=0.0, normalize=True)
    layer: Model[Any, Any] = chain(
        _extractor(), list2ragged(), with_array(concatenate(*tables)), with_array(mix), ragged2list()
    )
    return layer


def _extractor() -> Model[Any, Any]:
    known: dict[int, tuple[int, ...]] = {}

    def forward(model: Model[Any, Any], docs: Sequence[Doc], is_train: bool) -> tuple[list[Any], Callable[..., Any]]:  # noqa: ARG001, FBT001 - the form that thinc calls
        if len(known) > _KEPT_WORDS:
            known.clear()
        return [_ids(doc, known) for doc in docs], lambda _: []

    return Model("affixes", forward)


def _ids(doc: Doc, known: dict[int, tuple[int, ...]]) -> np.ndarray[Any, np.dtype[np.uint64]]:
    rows = []
    for orth, token in zip(doc.to_array("ORTH").tolist(), doc, strict=True):
        row = known.get(orth)
        if row is None:
            row = known[orth] = tuple(hash_string(one) for one in features(token.text))
        rows.append(row)
    return np.asarray(rows, dtype=np.uint64).reshape(len(rows), len(FEATURES))


def _shape(word: str) -> str:
    kinds: list[str] = []
    for sign in word:
        kind = "X" if sign.isupper() else "x" if sign.isalpha() else "d" if sign.isdigit() else sign
        if kinds[-_RUN:] != [kind] * _RUN:
            kinds.append(kind)
    return "".join(kinds)


registry.architectures.register("kg.AffixEmbed.v1", func=affix_embed)
