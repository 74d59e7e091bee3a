"""Prose told from everything else that stands in comments and pages: licences, code, directives, templates.

`is_prose` judges one paragraph of plain text. It is a matter of words and signs alone, so it holds for any language
of man; what it refuses by words is English, as licences and templates are.
"""

from __future__ import annotations

import re
from typing import Final

__all__ = ["LONGEST_TEXT", "is_legal", "is_prose", "shortened"]

LONGEST_TEXT: Final = 1000
"""Characters of a description: the longest paragraphs that say what a node is for have about 800."""

_FEWEST_WORDS: Final = 3
"""`Laser scan merger` says something; two words are a label."""
_FEWEST_LETTERS: Final = 10
_LETTERS_SHARE: Final = 0.72
"""Of the signs that are no space; English prose has 0.95, tables and formulas less than 0.6."""
_ALONE: Final = 0.6
"""So much of a text may addresses and paths take."""

_LEGAL: Final = re.compile(
    r"copyright\b|\(c\) ?\d{4}|©|all rights reserved|\bSPDX\b|licen[sc]e agreement|licensed under|under the terms of"
    r"|redistributions? (?:and|of|in)|redistribute|in source and binary|above copyright"
    r"|neither the name|endorse or promote|provided by the copyright|without warrant(?:y|ies)|without any warranty"
    r"|merchantab|fitness for a particular|liable for any|such damage|express or implied|applicable law"
    r"|obtain a copy of the license|copy of the (?:gnu|license|mit|apache|bsd)|for more details\.?$"
    r"|gnu (?:lesser |affero |library )?general public|\b[al]?gpl ?v?[23]?\b"
    r"|permission (?:is|to use)|hereby granted|creative commons|public domain|\b(?:bsd|mit|apache) licen[sc]e"
    r"|see (?:the )?licen[sc]e|licen[sc]e (?:file|for the specific)|specific language governing"
    r"|^(?:the )?licen[sc]e\b|trade ?secret|proprietary|^this file is part of"
    r"|free software foundation|this (?:software|program) is free|^(?:modified )?(?:3-clause )?bsd\b"
    r"|is released (?:under|with)|is made available under|released under",
    re.IGNORECASE,
)
_BOILERPLATE: Final = re.compile(
    r"\b(?:TODO|FIXME|XXX|HACK)\b|^The \S+ package\.?$|package description|provide an overview of your package"
    r"|(?:auto(?:matically)?[- ]?|was |is )generated (?:by|from|file|code|with)|auto-?generated"
    r"|do not (?:edit|modify)\b"
    r"|catkin_create_pkg|roscreate|this is a sample|for template parameter list|vim?:|-\*-|pylint|cpplint|NOLINT"
    r"|clang-format|^\S+ is \.\.\.|\bno (?:public )?code api|not have a (?:public )?code api|for usage see|htmlinclude"
    r"|^list of (?:nodes|topics)|foo_service|noqa|coding[:=]|flake8|doxygen|^created (?:on|by|in)\b"
    r"|^\s*(?:created|generated) (?:on|by|with|from)\b"
    r"|^(?:authors?|maintainers?|date|version|e-?mail|status|contact|desc|revision|file ?name|file|project|written by"
    r"|website|url|license|maintained by|modified by|original author|contributors?)\b\s*[:=(]"
    r"|^(?:authors?|written|developed|maintained|modified|ported) by\b|^(?:author|maintainer)s?\b"
    r"|@\w+\.(?:com|org|de|edu|net|jp|fr|es|it|uk)\b",
    re.IGNORECASE,
)
_LABEL: Final = re.compile(
    r"^(?:(?:the |a |this is the |define |start of )?main(?: function| loop| program| entry point| node)?"
    r"s?(?: for .{0,30})?"
    r"|(?:the )?(?:con|de)structors?(?: (?:for|of) .{0,40})?|(?:default |forward )?(?:declarations?|constructor)"
    r"|(?:(?:ros|c\+\+|stl|std|standard|local|system|custom|own|boost|pcl|opencv|eigen|project|other|common|necessary"
    r"|required|third[- ]party|external|library|global|python|message|msgs?|and|c|for|import|include|\W)+ ?)*"
    r"(?:includes?|headers?|imports?|library|libraries|messages?|msgs?|stuff|files|variables|typedefs|constants)"
    r"|forward declarations?|function (?:prototypes|declarations)|class (?:definition|declaration)s?|see .{0,60}"
    r"|\$id.*|(?:this )?(?:class|function|file|node)|end of .*|namespace .*|for debug\w*|needed for .*)\W*$",
    re.IGNORECASE,
)
_CODE: Final = re.compile(
    r"[;{}]\s*$|^\s*[#{}]|\w\(\)|->|==|!=|&&|\|\||\+\+|<<|>>|::\w+\(|^(?:from \S+ )?import \w+(?:\.\w+)*$|^#\s*\w+"
    r"|\breturn\b.*;|^\s*(?:if|for|while|switch)\s*\(|\w+\[\w*\]\s*=|^\s*[\w.:<>*&]+(?: [\w*&]+)? ?\+?= ?\S+"
    r"|^\s*(?:self\.|\$ |sudo |roslaunch |rosrun |ros2 |git |catkin_make|colcon |cd |def \w+\(|class \w+[(:]|print\b)"
    r"|\bstd::\w+<|^\s*[\w.:]+\([^)]*\)\s*:?$|^<\w+[^>]*>|\w+\s*=\s*[\w.:]+\([^)]*\)$|%[sdf]\b"
)
_ADDRESS: Final = re.compile(r"(?:https?|ftp)://\S+|www\.\S+|\S+@\S+\.\w+|(?:^|(?<=\s))[~.]?/?(?:[\w.-]+/){2,}[\w.-]*")
_LATIN_WORD: Final = re.compile(r"[^\W\d_]{2,}")
_SENTENCE_END: Final = re.compile(r"[.!?。]\s")


def is_legal(text: str) -> bool:
    """Tell whether a paragraph is (part of) a licence or a copyright notice."""
    return _LEGAL.search(text[: 4 * LONGEST_TEXT]) is not None


def is_prose(text: str) -> bool:
    """Tell whether a paragraph of plain text is prose that may describe something.

    False for licences, commented-out code, separators, editor and linter directives, tags of authors and dates, open
    work, templates, addresses alone, labels of one or two words, and what is mostly signs.
    """
    text = text[: 4 * LONGEST_TEXT].strip()
    bare = _ADDRESS.sub(" ", text)
    if len(bare) < len(text) * (1 - _ALONE):
        return False
    letters = sum(map(str.isalpha, bare))
    solid = len(bare) - sum(map(str.isspace, bare))
    if letters < _FEWEST_LETTERS or letters < _LETTERS_SHARE * solid:
        return False
    words = _LATIN_WORD.findall(bare)
    if len(words) < _FEWEST_WORDS and not _without_spaces(bare):
        return False
    return not (is_legal(text) or _BOILERPLATE.search(text) or _LABEL.match(text) or _CODE.search(bare))


def _without_spaces(text: str) -> bool:
    """Tell whether a text is of a script that has no spaces between words."""
    return sum(not char.isascii() and char.isalpha() for char in text) >= _FEWEST_LETTERS


def shortened(text: str, most: int = LONGEST_TEXT) -> str:
    """Return a text cut at the end of a sentence, or else of a word, where it has more than `most` characters."""
    if len(text) <= most:
        return text
    ends = [match.end() for match in _SENTENCE_END.finditer(text, 0, most)]
    if ends and ends[-1] > most // 2:
        return text[: ends[-1]].rstrip()
    return text[: most - 1].rpartition(" ")[0].rstrip() + "…"
