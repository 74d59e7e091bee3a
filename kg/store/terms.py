r"""Spelling of terms as text, the same in the store, in its dumps and in columns.

Terms are spelt in N-Triples syntax (W3C RDF 1.2 N-Triples), with the escapes of its canonical form, and with the value
that the store returns:

    <urn:a>  _:b0  "text"  "text"@en  "text"@ar--rtl  "1"^^<http://www.w3.org/2001/XMLSchema#integer>
    <<( <urn:a> <urn:p> "x" )>>

The store encodes values of numbers, booleans, dates, times and durations rather than their text, so these have one
spelling each: `"01"^^xsd:integer`, `"+1"^^xsd:integer` and `"1"^^xsd:byte` all are `"1"^^xsd:integer`. Language
tags are in lower case. In all rules, terms are equal if their spellings are.

The label of a blank node is its identity within a store. Labels in files are local to the file, so blank nodes get new
labels when a file is read (`rename_blank_nodes`).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from typing import Final, TypeAlias, cast

from pyoxigraph import BlankNode, Literal, NamedNode, Quad, RdfFormat, Store, Triple, parse

Term: TypeAlias = NamedNode | BlankNode | Literal | Triple

BLANK_MARK: Final = b"_:"
"""Beginning of each blank node; text without it has none."""

_XSD: Final = "http://www.w3.org/2001/XMLSchema#"
_STRING: Final = f"{_XSD}string"
_XSD_BYTES: Final = _XSD.encode()
_ANYTHING: Final = NamedNode("urn:kg:anything")

_SPECIAL: Final = re.compile(r'["\\\x00-\x1f\x7f\ud800-\udfff]')
_ESCAPES: Final = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t", "\b": "\\b", "\f": "\\f"}

_CONTROLS: Final = bytes([*range(9), 11, 12, *range(14, 32), 127])
"""Control characters that TSV does not escape in strings; tabs and line ends are escaped in both formats."""
_NO_CHARACTERS: Final = (b"\xef\xbf\xbe", b"\xef\xbf\xbf")
"""U+FFFE and U+FFFF, which N-Triples escapes too."""
_ESCAPED: Final = re.compile(rb"[\x00-\x1f\x7f]|\xef\xbf[\xbe\xbf]")
_INSIDE: Final = re.compile(rb'"(?:[^"\\]|\\.)*"|<[^<>]*>|(?<= )(?:[+-]?[0-9.]+|true|false)(?= \)>>)')
"""In a triple term: strings and IRIs to skip, and short forms in the position of the object."""

_PLAIN: Final = re.compile(
    rb'<[^\x00-\x20<>"{}|^`\\]*>|"(?:[^"\\\n\r]|\\["\\nrtbf])*"(?:@[a-z]+)?'
    rb'|"(?:0|-?[1-9][0-9]{0,17})"\^\^<http://www\.w3\.org/2001/XMLSchema#integer>'
)
"""Terms already written in their spelling, which most are: IRIs, strings, texts with a language, integers."""
_STRANGE: Final = (b"\n", b"\r", BLANK_MARK, b"<<", b"\\u", b"\\U", *_NO_CHARACTERS)


def spell(term: Term) -> bytes:
    """Return the spelling of a term, the same as in a dump of the store."""
    if isinstance(term, NamedNode):
        return b"<" + term.value.encode() + b">"
    if isinstance(term, Triple):
        # The library serializes a triple as a statement, but inside another triple as a term.
        return b"<<( %s %s %s )>>" % (spell(term.subject), spell(term.predicate), spell(term.object))
    if isinstance(term, Literal) and term.datatype.value.startswith(_XSD) and term.datatype.value != _STRING:
        term = _stored(term)
    return str(term).encode()


@lru_cache(maxsize=4096)
def _stored(written: Literal) -> Literal:
    """Return a literal as the store returns it."""
    store = Store()
    store.add(Quad(_ANYTHING, _ANYTHING, written))
    return cast("Literal", next(iter(store)).object)


def of_spelling(text: str | bytes) -> Term:
    """Return the term with the N-Triples syntax `text`; SyntaxError unless it is exactly one term."""
    written = text.encode() if isinstance(text, str) else text
    parsed = list(parse(b"<urn:s> <urn:p> " + written + b" .", RdfFormat.N_TRIPLES))
    if len(parsed) != 1:
        raise SyntaxError("not one term")
    return cast("Term", parsed[0].object)


def literal(text: str) -> str:
    """Return the spelling of a string literal; surrogates (bytes that are not UTF-8) become U+FFFD."""
    return f'"{_SPECIAL.sub(_escape, text)}"' if _SPECIAL.search(text) else f'"{text}"'


def _escape(match: re.Match[str]) -> str:
    character = match[0]
    if character >= "\ud800":
        return "\ufffd"
    return _ESCAPES.get(character) or f"\\u{ord(character):04X}"


def datatype(spelling: bytes) -> bytes:
    """Return the spelling of a literal's datatype, from the spelling of the literal."""
    if spelling.endswith(b'"'):
        return b"<%sstring>" % _XSD_BYTES
    if spelling.endswith(b">"):
        return spelling[spelling.rindex(b"<") :]
    # A language tag never contains two adjacent hyphens; they begin the direction of a text (RDF 1.2).
    directed = b"--" in spelling[spelling.rindex(b'"') :]
    return b"<http://www.w3.org/1999/02/22-rdf-syntax-ns#%s>" % (b"dirLangString" if directed else b"langString")


def split_blank(lines: bytes) -> tuple[bytes, bytes]:
    """Return the lines of N-Triples or N-Quads without blank nodes, and those that may have one."""
    plain, others, begin = [], [], 0
    while (mark := lines.find(BLANK_MARK, begin)) >= 0:
        start = lines.rfind(b"\n", begin, mark) + 1 or begin
        end = lines.find(b"\n", mark) + 1 or len(lines)
        plain.append(lines[begin:start])
        others.append(lines[start:end])
        begin = end
    return b"".join([*plain, lines[begin:]]), b"".join(others)


def parts_of_lines(text: bytes) -> list[bytes] | None:
    """Return the spellings of the terms in N-Triples, three for each line; None for a text that needs a real parser.

    If strings contain separators, the count does not match the number of lines, and the result is None.
    """
    number = text.count(b"\n")
    if text.count(b" .\n") != number or text[-1:] not in {b"\n", b""} or b"\t" in text:
        return None
    parted = text.replace(b" .\n", b"\t").replace(b"> <", b">\t<").replace(b'> "', b'>\t"')
    parts = parted.split(b"\t")
    parts.pop()
    if len(parts) != 3 * number:
        return None
    different = set(parts)
    once = b"\t".join(different)
    if any(one in once for one in _STRANGE) or len(once.translate(None, _CONTROLS)) != len(once):
        return None
    others = [part for part in different if not _PLAIN.fullmatch(part)]
    try:
        spelt = _spelt(others)
    except SyntaxError:
        return None
    if len(spelt) != len(others):
        return None
    return [spelt.get(part, part) for part in parts] if spelt else parts


def _spelt(written: list[bytes]) -> dict[bytes, bytes]:
    """Return the spellings of literals in N-Triples syntax; SyntaxError for an invalid one."""
    store = Store()
    lines = b"".join(b"<urn:%d> <urn:p> %s .\n" % (number, one) for number, one in enumerate(written))
    store.extend(parse(lines, RdfFormat.N_TRIPLES))
    return {written[int(quad.subject.value[4:])]: str(quad.object).encode() for quad in store}


def cells(text: bytes, width: int) -> list[bytes]:
    """Return the spellings of the cells of a TSV table (without its header line), row by row.

    Each row has `width` cells, none empty. TSV (SPARQL 1.1 Query Results CSV and TSV Formats, section 4) may write
    numbers and booleans without quotes and datatype, and does not escape control characters in strings, unlike
    N-Triples.
    """
    spellings = text.replace(b"\n", b"\t").split(b"\t")
    spellings.pop()
    for repair in _repairs(text):
        for column in range(width):
            spellings[column::width] = map(repair, spellings[column::width])
    return spellings


def _repairs(text: bytes) -> list[Callable[[bytes], bytes]]:
    """Return the required corrections of the cells of a text; a scan of the whole text shows that most need none."""
    needed: list[Callable[[bytes], bytes]] = []
    regular = text.count(b"\t<") + text.count(b'\t"') + text.count(b"\t_")
    regular += text.count(b"\n<") + text.count(b'\n"') + text.count(b"\n_") + (text[:1] in {b"<", b'"', b"_"})
    if regular != text.count(b"\t") + text.count(b"\n"):
        needed.append(_long)
    if b"<<(" in text:
        needed.append(_triple)
    if len(text.translate(None, _CONTROLS)) != len(text) or any(one in text for one in _NO_CHARACTERS):
        needed.append(_escape_cell)
    return needed


def _long(cell: bytes) -> bytes:
    if cell[:1] in {b"<", b'"', b"_"}:
        return cell
    if cell in {b"true", b"false"}:
        return b'"%s"^^<%sboolean>' % (cell, _XSD_BYTES)
    return b'"%s"^^<%s%s>' % (cell, _XSD_BYTES, b"decimal" if b"." in cell else b"integer")


def _triple(cell: bytes) -> bytes:
    return _INSIDE.sub(lambda match: _long(match[0]), cell) if cell.startswith(b"<<(") else cell


def _escape_cell(cell: bytes) -> bytes:
    return cell if cell.startswith(b"<") and not cell.startswith(b"<<(") else _ESCAPED.sub(_escape_bytes, cell)


def _escape_bytes(match: re.Match[bytes]) -> bytes:
    short = {b"\b": b"\\b", b"\f": b"\\f"}.get(match[0])
    return short or b"\\u%04X" % ord(match[0].decode())
