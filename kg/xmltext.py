"""Parser for untrusted XML: no entities, no DTD, no network, limited depth; it recovers well-formed parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.lazily import lazily

if TYPE_CHECKING:
    from lxml.etree import _Element

with lazily():
    from lxml import etree

__all__ = ["XmlResult", "line_of", "parse_xml"]


@dataclass(frozen=True, slots=True)
class XmlResult:
    """The root element, as far as it could be parsed, and the problems of the text, as (code, message, line)."""

    root: _Element | None
    problem: tuple[str, str, int | None] | None = None


def line_of(element: _Element) -> int:
    """Return the line an element starts on."""
    return int(getattr(element, "sourceline", None) or 1)


def parse_xml(text: bytes) -> XmlResult:
    """Parse UTF-8 `text`; the declaration of another encoding is overridden, entities are refused."""
    if b"<!ENTITY" in text:
        line = text[: text.index(b"<!ENTITY")].count(b"\n") + 1
        return XmlResult(None, ("KG116", "defines entities, which are refused", line))
    try:
        return XmlResult(_parse(text, recover=False))
    except etree.XMLSyntaxError as error:
        deep = "depth" in str(error).lower()
        message = "nests too deep" if deep else f"is not well-formed: {error.msg}"
        problem = ("KG114" if deep else "KG116", message, error.lineno)
    try:
        return XmlResult(_parse(text, recover=True) if text.strip() else None, problem)
    except etree.XMLSyntaxError:
        return XmlResult(None, problem)


def _parse(text: bytes, *, recover: bool) -> _Element | None:
    parser = etree.XMLParser(encoding="utf-8", recover=recover, resolve_entities=False, no_network=True, load_dtd=False)
    return etree.fromstring(text, parser)
