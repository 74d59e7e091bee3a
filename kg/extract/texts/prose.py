"""Prose told from everything else that stands in comments and pages: licences, code, directives, templates.

`is_prose` judges one paragraph of plain text. It is a matter of words and signs alone, so it holds for any language
of man; what it refuses by words is English, as licences and templates are.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final

from kg.extract.texts.phrases import AUTHORSHIP, BOILERPLATE, LABELS, LEGAL, LISTED, LISTING

__all__ = ["LONGEST_TEXT", "is_legal", "is_prose", "shortened"]

LONGEST_TEXT: Final = 1000
"""Characters of a description: the longest paragraphs that say what a node is for have about 800."""

_JUDGED: Final = 4 * LONGEST_TEXT
"""Characters that are judged; a longer paragraph is no paragraph."""
_REMEMBERED: Final = 4096
"""Judgements that are kept: the files of a package begin with the same licence."""
_FEWEST_WORDS: Final = 3
"""`Laser scan merger` says something; two words are a label."""
_FEWEST_LETTERS: Final = 10
_LETTERS_SHARE: Final = 0.72
"""Of the signs that are no space; English prose has 0.95, tables and formulas less than 0.6."""
_ADDRESSES_SHARE: Final = 0.6
"""So much of a text may addresses and paths take."""

_CODE_SIGNS: Final = re.compile(r"[;{}=&|+<>\[\]$#%(]|^~|^import |^from ")
_CODE: Final = re.compile(
    r"[;{}]\s*$|^\s*[#{}$]|^~\w|\w\(\)\s*[;.{]|->\w|==|!=|:=|&&|\|\||\+\+\w|\w\+\+[;)]|<<|>>|::\w+\("
    r"|^(?:from \S+ )?import \w[\w., ]*$"
    r"|^\s*(?:if|for|while|switch)\s*\(|\w+\[\w*\]\s*=|^\s*[\w.:<>*&]+(?: [\w*&]+)? ?\+?= ?\S+"
    r"|^\s*(?:self\.|def \w+\(|class \w+[(:]|print\b)|\bstd::\w+<|^\s*[\w.:]+\([^)]*\)\s*:?$|^<\w+[^>]*>"
    r"|\w+\s*=\s*[\w.:]+\([^)]*\)$|%[sdf]\b"
)
_COMMAND: Final = re.compile(
    r"^\s*(?:sudo|roslaunch|rosrun|ros2|git|catkin_make|catkin|colcon|cd|pip3?|apt(?:-get)?) \S"
)
_PLACE: Final = re.compile(
    r"(?:https?|ftp)://\S+|www\.\S+|[\w.+-]{1,64}@[\w-]{1,63}\.\w+|(?:^|(?<=\s))[~.]?/?(?:[\w.-]+/){2,}[\w.-]*"
)
_WORD: Final = re.compile(r"[^\W\d_]{2,}")
_FIELD: Final = re.compile(r"(?:^| )[\w-]+: \S")
_MOST_FIELDS: Final = 3
"""So many `key: value` in what is no sentence are data."""
_PERSON: Final = r"(?:[A-Z][\w.'-]*\s+){1,3}[A-Z][\w'-]+"
_PEOPLE: Final = re.compile(rf"^{_PERSON}(?:(?:\s*[,;]|\s+and)\s+{_PERSON})+\W*$")
_SENTENCE_END: Final = re.compile(r"[.!?。]\s")


def is_legal(text: str) -> bool:
    """Tell whether a paragraph is (part of) a licence or a copyright notice."""
    low = text[:_JUDGED].lower()
    return any(phrase in low for phrase in LEGAL)


@lru_cache(_REMEMBERED)
def is_prose(text: str) -> bool:
    """Tell whether a paragraph of plain text is prose that may describe something.

    False for licences, commented-out code, separators, editor and linter directives, tags of authors and dates, open
    work, templates, addresses alone, labels of one or two words, and what is mostly signs.
    """
    text = text[:_JUDGED].strip()
    bare = _PLACE.sub(" ", text) if "/" in text or "@" in text or "www" in text else text
    if len(bare) < len(text) * (1 - _ADDRESSES_SHARE) or not _has_words(bare):
        return False
    low = text.lower()
    if any(phrase in low for phrase in LEGAL) or any(phrase in low for phrase in BOILERPLATE):
        return False
    if LABELS.match(low) or AUTHORSHIP.match(low) or _is_listing(low):
        return False
    if len(_FIELD.findall(text)) >= _MOST_FIELDS and ". " not in text:
        return False
    if _PEOPLE.match(text) or _COMMAND.match(text) or _is_lead_in(text):
        return False
    return not (_CODE_SIGNS.search(bare) and _CODE.search(bare))


def _has_words(text: str) -> bool:
    """Tell whether a text has letters and words enough, of which scripts without spaces have one."""
    letters = sum(map(str.isalpha, text))
    solid = len(text) - sum(map(str.isspace, text))
    if letters < _FEWEST_LETTERS or letters < _LETTERS_SHARE * solid:
        return False
    if len(_WORD.findall(text)) >= _FEWEST_WORDS and " " in text.strip():
        return True
    return not text.isascii() and sum(not char.isascii() and char.isalpha() for char in text) >= _FEWEST_LETTERS


def _is_listing(low: str) -> bool:
    """Tell whether a text is the label of a group of includes (`standard C++ headers`)."""
    label = low.strip(" .:-=")
    return LISTED.search(label) is not None and all(map(LISTING.match, label.split()))


def _is_lead_in(text: str) -> bool:
    """Tell whether a paragraph only announces what follows it (`Run it as:`)."""
    return text.endswith(":") and _SENTENCE_END.search(text) is None


def shortened(text: str, most: int = LONGEST_TEXT) -> str:
    """Return a text cut at the end of a sentence, or else of a word, where it has more than `most` characters."""
    if len(text) <= most:
        return text
    ends = [match.end() for match in _SENTENCE_END.finditer(text, 0, most)]
    if ends and ends[-1] > most // 2:
        return text[: ends[-1]].rstrip()
    return text[: most - 1].rpartition(" ")[0].rstrip() + "…"
