"""Lemmas of words from their letters and Penn tags, by a table of exceptions and a table of endings.

spaCy's trainable lemmatizer selects among edits of the word as written, including capitals. Endings in English are
determined by the tag, so a table of endings is smaller, faster, and more often right for words missing from treebanks;
`benchmarks/language` measures both.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from spacy.language import Language

if TYPE_CHECKING:
    from pathlib import Path

    from spacy.tokens import Doc
    from spacy.vocab import Vocab

LONGEST_ENDING: Final = 6
"""Longest ending in characters."""

_FILE: Final = "lemmas.json"
_KEPT_WORDS: Final = 100_000  # number of cached lemmas; only malicious texts have more different words

Table = dict[str, dict[str, str]]
"""Tag to word to lemma, or tag to ending to replacement: the number of characters to remove, and the text to append."""


def lemma(word: str, tag: str, exceptions: Table, endings: Table) -> str:
    """Return the lemma of a word in lower case; the word itself for tags without endings, or if it contains digits."""
    form = word.lower()
    known = exceptions.get(tag, {}).get(form)
    if known is not None:
        return known
    of_tag = endings.get(tag)
    if not of_tag or any(sign.isdigit() for sign in form):
        return form
    for length in range(min(LONGEST_ENDING, len(form) - 1), -1, -1):
        edit = of_tag.get(form[len(form) - length :])
        if edit is not None:
            cut = int(edit[0])
            return form[: len(form) - cut] + edit[1:] if cut < len(form) else form
    return form


class Lemmas:
    """Pipeline component that sets the lemmas of tagged documents."""

    def __init__(self, vocab: Vocab) -> None:
        self.vocab = vocab
        self.exceptions: Table = {}
        self.endings: Table = {}
        self._known: dict[tuple[int, int], int] = {}

    def __call__(self, doc: Doc) -> Doc:
        """Set the lemma of each token of a tagged document."""
        if len(self._known) > _KEPT_WORDS:
            self._known.clear()
        pairs = doc.to_array(["ORTH", "TAG"]).tolist()
        found: Any = np.asarray([self._lemma(orth, tag) for orth, tag in pairs], dtype=np.uint64)
        doc.from_array(["LEMMA"], found.reshape(len(pairs), 1))
        return doc

    def _lemma(self, orth: int, tag: int) -> int:
        known = self._known.get((orth, tag))
        if known is None:
            strings = self.vocab.strings
            text = lemma(strings[orth], strings[tag], self.exceptions, self.endings)
            known = self._known[orth, tag] = strings.add(text)
        return known

    def to_disk(self, path: Path, exclude: Any = ()) -> None:  # noqa: ARG002 - signature required by spaCy
        """Write the tables into the folder `path`."""
        path.mkdir(parents=True, exist_ok=True)
        tables = {"exceptions": self.exceptions, "endings": self.endings}
        text = json.dumps(tables, ensure_ascii=False, sort_keys=True, separators=(",", ":"))
        (path / _FILE).write_text(text + "\n", encoding="utf-8")

    def from_disk(self, path: Path, exclude: Any = ()) -> Lemmas:  # noqa: ARG002 - signature required by spaCy
        """Read the tables from the folder `path`."""
        tables = json.loads((path / _FILE).read_text("utf-8"))
        self.exceptions, self.endings = tables["exceptions"], tables["endings"]
        self._known.clear()
        return self


@Language.factory("kg_lemmas")
def _make(nlp: Language, name: str) -> Lemmas:  # noqa: ARG001 - signature required by spaCy
    return Lemmas(nlp.vocab)
