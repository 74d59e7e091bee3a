"""READMEs and other pages of documentation: which of their paragraphs describe the package, and which a node.

A section whose heading names a node is about that node. So are a paragraph that names one, an item `name: what it does`
and a row of a table that begins with the name. What is before the first section of a package's README is about
the package.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from kg.extract.texts.pages import Block, BlockKind
from kg.extract.texts.paragraphs import plain
from kg.extract.texts.prose import is_legal, is_prose, shortened
from kg.names import key

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Iterator

    from kg.extract.texts.naming import Names

_REMEMBERED: Final = 2048
"""Headings whose meaning is kept, for many pages have the same."""

_NEVER: Final = (
    "install|licen[sc]e|citation|citing|cite|bibtex|contribut|changelog|change log|release|credit|acknowledg|author",
    "maintainer|to-?do|roadmap|prerequisite|requirement|dependenc|docker|publication|copyright|table of contents",
    "troubleshoot|known issue|build|compil|download|ci$|continuous integration|status|testing|tests?$|migrat|upgrad",
    "node_name|code api|contact|faq|supported (?:devices|hardware|platform)",
)
_INTERFACE: Final = (
    "parameter|argument|param|subscri|publish|topic|service|action|input|output|config|usage|launch|run(?:ning)?$",
    "run(?:ning)? |ros(?:run|launch)|ros2 |~|example|api$|tf$|transform|command line|option",
    "messages|how to|tutorial|quick|demo|sample",
)
_OTHER: Final = (
    "reference|support|bug|getting|set-?up|paper|develop|disclaimer|links|related|video|note|coding|debug|news|update",
    "history|issues|help|simulat|calibrat|performance|benchmark|evaluation|result|todo|workspace|file|folder|plugin$",
)
_ABOUT: Final = (
    "overview|description|introduc|about|feature|summary|what|purpose|synopsis|abstract|concept|functional",
)


def _any(words: tuple[str, ...]) -> re.Pattern[str]:
    return re.compile(rf"(?:\b|^)(?:{'|'.join(words)})", re.IGNORECASE)


_NEVER_PATTERN: Final = _any(_NEVER)
_INTERFACE_PATTERN: Final = _any(_INTERFACE)
_OTHER_PATTERN: Final = _any(_OTHER)
_ABOUT_PATTERN: Final = _any(_ABOUT)


@lru_cache(_REMEMBERED)
def is_never(heading: str) -> bool:
    """Return whether nothing below a heading is a description, whatever it names."""
    return _NEVER_PATTERN.search(heading) is not None and not is_about(heading)


@lru_cache(_REMEMBERED)
def is_interface(heading: str) -> bool:
    """Return whether a section lists topics, parameters or ways to start something."""
    return _INTERFACE_PATTERN.search(heading) is not None


@lru_cache(_REMEMBERED)
def is_about(heading: str) -> bool:
    """Return whether a section describes the subject of the section around it."""
    return _ABOUT_PATTERN.search(heading) is not None


@lru_cache(_REMEMBERED)
def is_telling(heading: str) -> bool:
    """Return whether the section below the title of a README describes the package."""
    return not (is_never(heading) or is_interface(heading) or _OTHER_PATTERN.search(heading))


_SPAN: Final = re.compile(
    r"``?([^`]{1,120})``?|\*\*([^*]{1,120})\*\*|__([^_].{0,120}?)__|<(?:b|code|tt|strong)>([^<]{1,120})</",
    re.IGNORECASE,
)
_LEAD: Final = re.compile(
    r"^[\s*`_\[]*(?:<\w+>)?([\w./:\-]{2,80}?(?: (?:node|nodelet|component))?)[\s*`_\]]*(?:</\w+>)?"
    r"(?:\([^)]{0,200}\))?\**\s*[:\-\u2013\u2014]+\**\s+(\S.*)$"
)
_TOPIC_LIKE: Final = re.compile(
    r"^(?:~|/)\w|^[\w/~.]+\s?[(\[](?:\w+_msgs|(?:string|int|float|double|bool|list)\b)", re.IGNORECASE
)
"""A topic or parameter of a node, in a list of them."""
_FIELD: Final = re.compile(r"^[a-z][a-z0-9_/]*$")
"""The first word of an item that explains a field, a parameter or a file."""
_TOKEN: Final = re.compile(r"[\w\-]+")
_FEWEST_SPACES: Final = 5
"""In an item about a package: shorter ones are a table of contents."""
_MOST_NODES: Final = 3
"""A paragraph that names more nodes than these lists them and describes none."""


@dataclass(frozen=True, slots=True)
class About:
    """Subjects of a page: the names of the nodes and of the package, and the names of other packages.

    `is_neighbour` tells whether another package of the repository has a name, given by its `kg.names.key`.
    `own` tells that the page belongs to the package.
    """

    names: Names
    package: str
    is_neighbour: Callable[[str], bool]
    own: bool


@dataclass(frozen=True, slots=True)
class Passage:
    """A paragraph of a page that describes something: a node, or the package where `node` is None."""

    text: str
    line: int
    node: str | None
    heading: str | None


@dataclass(slots=True)
class _Section:
    """The heading that the pass is below; `nodes` and `package` are its subjects."""

    heading: str
    level: int
    nodes: tuple[str, ...] = ()
    package: bool = False
    foreign: bool = False
    never: bool = False
    """Whether it or a section around it holds no descriptions."""
    inside: bool = False
    """Whether it or one around it is about something other than what its title names."""


def find(blocks: Iterable[Block], about: About) -> Iterator[Passage]:
    """Yield the paragraphs of a page that describe the package or one of its nodes, in their order."""
    stack = [_Section("", 0, package=about.own)]
    first_heading = True
    for block in blocks:
        if block.kind is BlockKind.HEADING:
            while len(stack) > 1 and stack[-1].level >= block.level:
                stack.pop()
            section = _section(block, stack[-1], about, title=first_heading)
            section.never = stack[-1].never or (is_never(section.heading) and not section.nodes)
            other = section.level > 1 and not section.nodes and not is_telling(section.heading)
            section.inside = stack[-1].inside or other
            stack.append(section)
            first_heading = False
            continue
        section = stack[-1]
        if block.kind is not BlockKind.CONTINUED and not (section.never or section.foreign):
            yield from _described(block, section, about)


def usage(blocks: Iterable[Block], described: Container[int]) -> Iterator[Passage]:
    """Yield each section of a page as one text, without its blocks at the lines `described`.

    Sections about installation, licences and the like are left out with those inside them (`is_never`).
    """
    section = Passage("", 0, None, None)
    never = 0
    for block in blocks:
        if block.kind is not BlockKind.HEADING:
            if not never and block.line not in described and not is_legal(block.text):
                section = replace(section, text=f"{section.text} {plain(block.text)}", line=section.line or block.line)
            continue
        if never and block.level > never:
            continue
        yield from _filled(section)
        section = Passage("", 0, None, plain(block.text) or None)
        never = block.level if is_never(section.heading or "") else 0
    yield from _filled(section)


def _filled(section: Passage) -> Iterator[Passage]:
    if text := section.text.strip():
        yield replace(section, text=shortened(text))


def _section(block: Block, outer: _Section, about: About, *, title: bool) -> _Section:
    heading = plain(block.text)
    nodes = about.names.of_heading(heading)
    named = key(heading.replace(" ", "")) in {key(about.package), key(about.package + "package")}
    plainly = not (about.own or named or nodes)
    foreign = plainly and any(about.is_neighbour(key(token)) for token in _TOKEN.findall(heading))
    if nodes or named:
        return _Section(heading, block.level, nodes, package=named or (not nodes and outer.package))
    telling = title or (is_about(heading) and is_telling(heading))
    inherited = outer.nodes if outer.nodes and is_about(heading) else ()
    package = outer.package and telling and not inherited
    return _Section(heading, block.level, inherited, package=package, foreign=foreign or outer.foreign)


def _described(block: Block, section: _Section, about: About) -> Iterator[Passage]:
    heading = section.heading or None
    if block.kind is BlockKind.ROW:
        yield from _row(block, heading, about)
        return
    text = plain(block.text)
    lead = _LEAD.match(block.text) if block.kind is BlockKind.ITEM else None
    if lead and (nodes := about.names.of_lead(plain(lead[1]))):
        if is_prose(plain(lead[2])):
            yield from (Passage(shortened(text), block.line, node, heading) for node in nodes)
        return
    if not is_prose(text) or _TOPIC_LIKE.match(text):
        return
    if lead and not about.own and key(plain(lead[1])) == key(about.package):
        yield Passage(shortened(text), block.line, None, heading)
        return
    if lead and _FIELD.match(plain(lead[1])) and not is_about(section.heading):
        return
    yield from _paragraph(block, text, section, about)


def _paragraph(block: Block, text: str, section: _Section, about: About) -> Iterator[Passage]:
    heading = section.heading or None
    if section.nodes:
        if block.kind is BlockKind.PARAGRAPH or not is_interface(section.heading):
            yield from (Passage(shortened(text), block.line, node, heading) for node in section.nodes[:_MOST_NODES])
        return
    if block.kind is BlockKind.PARAGRAPH and not section.inside:
        spans = [plain(next(filter(None, match.groups()), "")) for match in _SPAN.finditer(block.text[:4000])]
        nodes = about.names.of_text(text, spans)
        if nodes and len(nodes) <= _MOST_NODES:
            yield from (Passage(shortened(text), block.line, node, heading) for node in nodes)
    if section.package and (block.kind is BlockKind.PARAGRAPH or text.count(" ") >= _FEWEST_SPACES):
        yield Passage(shortened(text), block.line, None, heading)


def _row(block: Block, heading: str | None, about: About) -> Iterator[Passage]:
    cells = [plain(cell) for cell in block.text.split("\t")]
    if len(cells) < 2:  # noqa: PLR2004 - a name and what it does
        return
    description = max(cells[1:], key=len)
    if not is_prose(description):
        return
    nodes = about.names.of_lead(cells[0])
    if nodes:
        yield from (Passage(shortened(f"{cells[0]}: {description}"), block.line, node, heading) for node in nodes)
    elif not about.own and key(cells[0]) == key(about.package):
        yield Passage(shortened(description), block.line, None, heading)
