"""Comments become paragraphs of plain text: comment signs, Doxygen commands, HTML and Markdown signs are taken off."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.extract.texts.prose import LONGEST_TEXT, is_prose, shortened

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_MOST_LINES: Final = 400
"""Lines of one comment that are looked at; what a node is for stands in the first dozen."""
_LONGEST_LINE: Final = 2000
"""Characters of one line that are looked at, more than anybody writes."""

_LONGEST_PARAGRAPH: Final = 5 * LONGEST_TEXT
"""Characters of a paragraph that are looked at, more than are judged."""

_DECORATION: Final = re.compile(r"^[\s*/!#|<>\-=~_+.\"']*$")
_COMMAND: Final = re.compile(r"^[\s*\-]*[@\\](\w+)(?:\[\w+\])?\s*(.*)$")
_FRAME: Final = re.compile(r"\s\*+$")
"""The right side of a box drawn around a comment."""
_STARTING: Final = frozenset(
    {"brief", "short", "details", "note", "remark", "remarks", "mainpage", "par", "detail", "summary"}
)
_NAMING: Final = frozenset({"class", "struct", "fn", "namespace", "anchor", "package", "page"})
_INLINE: Final = frozenset({"b", "c", "e", "p", "a", "em", "ref", "link", "n", "li", "i"})
_BLOCKS: Final = {"code": "endcode", "verbatim": "endverbatim", "dot": "enddot", "htmlonly": "endhtmlonly"}
_ITEM: Final = re.compile(r"^\s*(?:[-*+•]|\d{1,2}[.)])\s+")
_FIELD: Final = re.compile(
    r"^:\w+[^:]*:|^(?:Args|Arguments|Parameters?|Returns?|Raises|Yields|Examples?|Usage|Inputs?|Outputs?|Attributes"
    r"|Authors?|Maintainers?|Contributors?|Date|Version|Email|E-mail|Created|Modified|File|Filename|License|Project"
    r"|Subscribe[sd]?|Publishe?[sd]?|Subscriptions?|Publications?|Topics?|Services?|TODO|FIXME)\s*:",
    re.IGNORECASE,
)
"""Beginnings of lines after which, up to an empty one, no description stands."""
_FILE_NAME: Final = re.compile(r"^[\w/.-]+\.(?:cpp|cc|cxx|c|hpp|hh|h|py|launch|xml)\b\W*", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Paragraph:
    """A paragraph with the line that it begins at; `command` is the Doxygen command it begins with."""

    line: int
    text: str
    command: str = ""


_INLINE_COMMAND: Final = re.compile(r"[@\\](?:b|c|e|p|a|em|ref|link|endlink|n|li|i|ingroup|brief|sa|see)\b\s*")
_ESCAPE: Final = re.compile(r"\\([_*#`<>\[\]~-])")
_TAG: Final = re.compile(r"</?[a-zA-Z][^<>]{0,300}>")
_IMAGE: Final = re.compile(r"!\[[^\]]{0,300}\](?:\([^)]{0,500}\)|\[[^\]]{0,100}\])")
_LINK: Final = re.compile(r"\[([^\[\]]{1,300})\](?:\([^()]{0,500}(?:\([^()]{0,100}\)[^()]{0,100})?\)|\[[^\]]{0,100}\])")
_RST_LINK: Final = re.compile(r"`([^`<>]{1,200}?)\s*<[^`<>]{1,400}>`_{0,2}")
_ROLE: Final = re.compile(r":[\w:+.-]{1,40}:`([^`]{1,200})`")
_EMPHASIS: Final = re.compile(r"(?<![\w*])(\*{1,3}|_{1,3})(?=\S)([^*\n]{1,400}?)(?<=\S)\1(?![\w*])")
_ENTITIES: Final = {"&lt;": "<", "&gt;": ">", "&nbsp;": " ", "&quot;": '"', "&#39;": "'", "&amp;": "&", "&mdash;": "-"}
_SPACE: Final = re.compile(r"\s+")


def plain(text: str) -> str:
    """Return a piece of Markdown, reStructuredText, HTML or Doxygen as the text that a reader would see."""
    text = text[:_LONGEST_PARAGRAPH]
    if "`" in text:
        text = _RST_LINK.sub(r"\1", _ROLE.sub(r"\1", text))
        text = text.replace("`_", "").replace("`", "")
    if "[" in text:
        text = _LINK.sub(r"\1", _IMAGE.sub("", text))
    if "<" in text:
        text = _TAG.sub("", text)
    if "*" in text or "_" in text:
        text = _EMPHASIS.sub(r"\2", text)
    if "@" in text or "\\" in text:
        text = _ESCAPE.sub(r"\1", _INLINE_COMMAND.sub("", text))
    if "&" in text:
        for entity, sign in _ENTITIES.items():
            text = text.replace(entity, sign)
    return _SPACE.sub(" ", text).strip()


def joined(lines: Iterable[tuple[int, str]]) -> Iterator[Paragraph]:
    """Yield the paragraphs of a comment, given its lines without comment signs; fields and code are left out."""
    gathered: list[str] = []
    first, command, until, silent = 0, "", "", False
    for number, (line, written) in enumerate(lines):
        if number >= _MOST_LINES:
            break
        text = written[:_LONGEST_LINE]
        match = _COMMAND.match(text)
        word = match[1].lower() if match else ""
        if until:
            until = "" if until in text else until
            continue
        if word in _BLOCKS and _BLOCKS[word] not in text:
            until = _BLOCKS[word]
        breaks = _DECORATION.match(text) or _FIELD.match(text.strip()) or _ITEM.match(text)
        if breaks or (word and word not in _INLINE):
            if gathered:
                yield Paragraph(first, plain(" ".join(gathered)), command)
            gathered, command = [], word
            silent = bool(word and word not in _STARTING | _NAMING | _INLINE) or _FIELD.match(text.strip()) is not None
            if match and word and word not in _INLINE:
                text = match[2] if word not in _NAMING else match[2].partition(" ")[2]
            text = _ITEM.sub("", text)
        content = _FRAME.sub("", text.strip(" \t|#"))
        if silent or _DECORATION.match(content):
            continue
        if not gathered:
            first = line
        gathered.append(content)
    if gathered:
        yield Paragraph(first, plain(" ".join(gathered)), command)


def prose(paragraphs: Iterable[Paragraph]) -> Iterator[Paragraph]:
    """Yield those paragraphs that are prose, cut to the longest text, without the name of the file in front."""
    for paragraph in paragraphs:
        text = _FILE_NAME.sub("", paragraph.text, count=1)
        if len(text) <= 4 * LONGEST_TEXT and is_prose(text):
            yield Paragraph(paragraph.line, shortened(text), paragraph.command)
