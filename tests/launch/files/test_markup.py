from __future__ import annotations

from dataclasses import dataclass, field

from kg.launch.files.markup import Document, Markup


@dataclass
class Node:
    """An element with its content."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Node | str] = field(default_factory=list)


def markup(*, whole_texts: bool) -> Markup[Node]:
    """Return a language whose elements store their content."""
    return Markup(Node, lambda parent, text, _: parent.children.append(text), whole_texts=whole_texts, cached=2)


def test_elements_know_the_line_of_their_start_tag() -> None:
    """The line is right even if the tag spans several lines."""
    read = markup(whole_texts=True).read(b'<a>\n<b\n x="1"/></a>')
    assert read == Document(Node("a", {}, 1, ["\n", Node("b", {"x": "1"}, 2)]))


def test_texts_come_whole_or_in_the_pieces_of_their_lines() -> None:
    """A caller that needs the lines of text receives pieces."""
    assert markup(whole_texts=True).read(b"<a>x\ny</a>").root == Node("a", {}, 1, ["x\ny"])
    assert markup(whole_texts=False).read(b"<a>x\ny</a>").root == Node("a", {}, 1, ["x", "\n", "y"])


def test_what_stands_before_an_error_is_kept() -> None:
    """Malformed text, entities and depth end the parsing with a message and a line."""
    read = markup(whole_texts=True).read(b"<a>\n<b/>\n</c>")
    assert read.root is not None
    assert read.root.children[1] == Node("b", {}, 2)
    assert read.problem == ("the file is not well-formed XML: mismatched tag", 3)
    entity = b'<!DOCTYPE a [\n<!ENTITY e "x">]><a/>'
    problem = ("the file defines the entity 'e'; entities are refused", 2)
    assert markup(whole_texts=True).read(entity) == Document(None, problem)
    deep = markup(whole_texts=True).read(b"<a>" * 61)
    assert deep.problem == ("elements are nested deeper than 60 levels; the file is not read on", 1)


def test_small_files_are_parsed_once() -> None:
    """Large files are parsed each time, to keep them out of the cache."""
    language = markup(whole_texts=True)
    small, large = b"<a/>", b"<a>" + b" " * (2 << 20) + b"</a>"
    assert language.read(small) is language.read(small)
    assert language.read(large) is not language.read(large)
