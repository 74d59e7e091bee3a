"""Tagged sentences from a treebank (CoNLL-U) and from files of `word/TAG`, as spaCy trains and scores on them."""

from __future__ import annotations

import gzip
import random
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from spacy.tokens import Doc
from spacy.training import Example
from spacy.util import registry

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from spacy.language import Language
    from spacy.vocab import Vocab

__all__ = ["Sentence", "read_tagged", "read_treebank", "reference", "varied"]

_LOWERED: Final = 0.08
"""How many sentences are read without capitals: comments begin with small letters."""
_UNENDED: Final = 0.25
"""How many sentences lose their full stop, as titles and comments have none."""
_REPEATED: Final = 4
"""How often an epoch reads the sentences about ROS, which are few."""
_RENAMED: Final = 0.5
"""How many identifiers and product codes in them are others each time."""
_NAME_PARTS: Final = (
    *("scan", "points", "image", "raw", "odom", "map", "base", "link", "cmd", "vel", "joint", "states", "camera"),
    *("front", "rear", "left", "right", "depth", "info", "pose", "goal", "imu", "data", "gps", "fix", "arm", "gripper"),
    *("wheel", "head", "tf", "laser", "cloud", "filtered", "status", "battery", "wrench", "min", "max", "range", "id"),
)
_TYPES: Final = ("LaserScan", "Imu", "PointCloud2", "Twist", "Odometry", "String", "JointState", "Image", "PoseArray")


@dataclass(frozen=True, slots=True)
class Sentence:
    """Words with their Penn tags; universal parts of speech and lemmas (lower case) where they are known.

    `spaces` tells after which words a space stands.
    """

    words: tuple[str, ...]
    spaces: tuple[bool, ...]
    tags: tuple[str, ...]
    parts: tuple[str, ...] | None = None
    lemmas: tuple[str, ...] | None = None


def read_treebank(path: Path) -> Iterator[Sentence]:
    """Yield the sentences of a file of CoNLL-U, gzip or not; empty nodes are left out, words of contractions kept."""
    opener = gzip.open if path.suffix == ".gz" else open
    with opener(path, "rt", encoding="utf-8") as lines:
        rows: list[list[str]] = []
        for line in lines:
            if line.strip() and not line.startswith("#"):
                rows.append(line.rstrip("\n").split("\t"))
            elif rows and not line.strip():
                yield _sentence(rows)
                rows = []
    if rows:
        yield _sentence(rows)


def _sentence(rows: list[list[str]]) -> Sentence:
    words = [row for row in rows if row[0].isdigit()]
    spaces = {row[0]: "SpaceAfter=No" not in row[9] for row in words}
    for row in rows:
        first, is_range, last = row[0].partition("-")
        if is_range:
            inner = {str(number): False for number in range(int(first), int(last))}
            spaces |= inner | {last: "SpaceAfter=No" not in row[9]}
    return Sentence(
        tuple(row[1] for row in words),
        tuple(spaces.values()),
        tuple(row[4] for row in words),
        tuple(row[3] for row in words),
        tuple(row[2].lower() for row in words),
    )


def read_tagged(path: Path) -> Iterator[Sentence]:
    """Yield the sentences of a file with one a line, as `word/TAG word/TAG`."""
    for line in path.read_text("utf-8").splitlines():
        pairs = [token.rpartition("/") for token in line.split()]
        words = tuple(word for word, _, _ in pairs)
        yield Sentence(words, _spaces(words), tuple(tag for _, _, tag in pairs))


def _spaces(words: tuple[str, ...]) -> tuple[bool, ...]:
    """Return where people put spaces: none before a full stop, nor at either side of a hyphen."""
    after = (*words[1:], "")
    return tuple(
        bool(follower) and follower not in {".", ",", ":", ")", "-", "/"} and word not in {"-", "(", "/"}
        for word, follower in zip(words, after, strict=True)
    )


def reference(vocab: Vocab, sentence: Sentence) -> Doc:
    """Return a sentence as the document that a pipeline should make of it."""
    return Doc(
        vocab,
        words=list(sentence.words),
        spaces=list(sentence.spaces),
        tags=list(sentence.tags),
        pos=list(sentence.parts) if sentence.parts else None,
        lemmas=list(sentence.lemmas) if sentence.lemmas else None,
    )


def varied(sentence: Sentence, chance: random.Random, *, rename: bool) -> Sentence:
    """Return a sentence as it could stand in a comment: in small letters, without its full stop, with other names."""
    words = sentence.words
    if rename:
        words = tuple(_renamed(word, chance) if chance.random() < _RENAMED else word for word in words)
    if chance.random() < _LOWERED:
        words = tuple(word.lower() for word in words)
    changed = replace(sentence, words=words)
    if len(words) > 1 and words[-1] == "." and chance.random() < _UNENDED:
        return Sentence(
            words[:-1],
            sentence.spaces[:-1],
            sentence.tags[:-1],
            sentence.parts and sentence.parts[:-1],
            sentence.lemmas and sentence.lemmas[:-1],
        )
    return changed


def _renamed(word: str, chance: random.Random) -> str:
    parts = [chance.choice(_NAME_PARTS) for _ in range(2)]
    package, _, name = word.partition("_msgs/")
    if name:
        return f"{parts[0]}_msgs/{chance.choice(_TYPES)}"
    if word.startswith("~"):
        return "~" + "_".join(parts)
    if word.startswith("/") and len(word) > 1:
        return "/" + chance.choice("/_").join(parts)
    if "_" in package:
        return "_".join(parts)
    if word[0].isupper() and any(sign.isdigit() for sign in word):
        letters = "".join(chance.choices("ABCDFGLMRSTUVX", k=chance.randint(1, 4)))
        return f"{letters}{chance.choice(('-', ''))}{chance.randint(1, 3000)}{chance.choice(('', '', 'LX', 'i'))}"
    return word


def tagged(treebank: str, part: str, sentences: str | None) -> Callable[[Language], Iterator[Example]]:
    """Return the reader of one part of a treebank; with `sentences` it varies them and adds those of that file."""
    own = list(read_treebank(Path(treebank) / f"{part}.conllu.gz"))
    added = list(read_tagged(Path(sentences))) if sentences else []
    chance = random.Random(5)  # noqa: S311 - reproducible, not secret

    def read(nlp: Language) -> Iterator[Example]:
        for sentence in own:
            yield _example(nlp, varied(sentence, chance, rename=False) if sentences else sentence)
        for sentence in added * _REPEATED:
            yield _example(nlp, varied(sentence, chance, rename=True))

    return read


def _example(nlp: Language, sentence: Sentence) -> Example:
    gold = reference(nlp.vocab, sentence)
    plain: Any = Doc(nlp.vocab, words=list(sentence.words), spaces=list(sentence.spaces))
    return Example(plain, gold)


registry.readers.register("kg.Tagged.v1", func=tagged)
