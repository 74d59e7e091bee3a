from __future__ import annotations

from kg.extract.launch.markup import Markup, kept_if_small

Node = tuple[str, dict[str, str], int, list["Node | str"]]


def make(tag: str, attributes: dict[str, str], line: int) -> Node:
    """Return an element without content."""
    return tag, attributes, line, []


def markup(*, whole_texts: bool) -> Markup[Node]:
    """Return a language whose elements keep all that is in them."""
    return Markup(
        make,
        lambda parent, child: parent[3].append(child),
        lambda parent, text, _: parent[3].append(text),
        whole_texts=whole_texts,
    )


def test_elements_know_the_line_of_their_start_tag() -> None:
    """Also where the tag goes over several lines."""
    found, problem = markup(whole_texts=True).read(b'<a>\n<b\n x="1"/></a>')
    assert found == ("a", {}, 1, ["\n", ("b", {"x": "1"}, 2, [])])
    assert problem is None


def test_texts_come_whole_or_in_the_pieces_of_their_lines() -> None:
    """Who has to know the lines of text is given pieces."""
    assert markup(whole_texts=True).read(b"<a>x\ny</a>")[0] == ("a", {}, 1, ["x\ny"])
    assert markup(whole_texts=False).read(b"<a>x\ny</a>")[0] == ("a", {}, 1, ["x", "\n", "y"])


def test_what_stands_before_an_error_is_kept() -> None:
    """Malformed text, entities and depth end the reading with a message and a line."""
    found, problem = markup(whole_texts=True).read(b"<a>\n<b/>\n</c>")
    assert found is not None
    assert found[3][1] == ("b", {}, 2, [])
    assert problem == ("the file is no well-formed XML: mismatched tag", 3)
    entity = b'<!DOCTYPE a [\n<!ENTITY e "x">]><a/>'
    assert markup(whole_texts=True).read(entity) == (
        None,
        ("the file defines the entity 'e'; entities are refused", 2),
    )
    _, problem = markup(whole_texts=True).read(b"<a>" * 61)
    assert problem == ("elements are nested deeper than 60 levels; the file is not read on", 1)


def test_small_files_are_parsed_once() -> None:
    """Large ones each time, so that the cache does not hold them."""
    seen = []
    parse = kept_if_small(lambda text: seen.append(len(text)), 2)
    for size in (1, 1, 2 << 20, 2 << 20):
        parse(b" " * size)
    assert seen == [1, 2 << 20, 2 << 20]
