"""Answers as text: the W3C formats of results and graphs, and those for people and line-wise tools.

Sources: SPARQL 1.1 Query Results JSON, XML, CSV and TSV Formats. `markdown` is a table; `jsonl` has one object a
row, with plain values for literals of numbers, booleans and strings.
"""

from __future__ import annotations

import csv
import io
import json
import re
from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import escape, quoteattr

import pyoxigraph
from pyoxigraph import BlankNode, Literal, NamedNode, RdfFormat

from kg.errors import QueryError
from kg.query.prefixes import PREFIXES, shorten
from kg.query.result import Boolean, Graph, Solutions
from kg.query.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.query.result import Result, Term

__all__ = ["BOOLEAN_FORMATS", "GRAPH_FORMATS", "SOLUTION_FORMATS", "display", "plain", "write"]

_XSD: Final = "http://www.w3.org/2001/XMLSchema#"
_STRING: Final = _XSD + "string"
_INTEGERS: Final = frozenset({_XSD + "integer", _XSD + "int", _XSD + "long", _XSD + "nonNegativeInteger"})
_DECIMALS: Final = frozenset({_XSD + "decimal", _XSD + "double", _XSD + "float"})
_WHOLE: Final = re.compile(r"[+-]?[0-9]+")
_NAMESPACE: Final = "http://www.w3.org/2005/sparql-results#"


def write(result: Result, name: str) -> bytes:
    """Return `result` in the format `name`.

    Raises:
        QueryError: KG504 naming the formats that this kind of answer has.
    """
    if isinstance(result, Graph):
        rdf_format = GRAPH_FORMATS.get(name)
        if rdf_format is None:
            raise _wrong(name, "a graph", list(GRAPH_FORMATS))
        prefixes = dict(PREFIXES) if name in {"turtle", "trig", "rdfxml"} else {}
        return pyoxigraph.serialize(result.triples, format=rdf_format, prefixes=prefixes) or b""
    if isinstance(result, Boolean):
        answer = BOOLEAN_FORMATS.get(name)
        if answer is None:
            raise _wrong(name, "yes or no", list(BOOLEAN_FORMATS))
        return answer(result.value).encode()
    table = SOLUTION_FORMATS.get(name)
    if table is None:
        raise _wrong(name, "rows", list(SOLUTION_FORMATS))
    return table(result).encode()


def _wrong(name: str, kind: str, known: list[str]) -> QueryError:
    hint = did_you_mean(name, known) or f"Use one of {', '.join(known)}."
    return QueryError(
        "KG504", f"the query answers {kind}, which `{name}` cannot hold; {', '.join(known)} can", hint=hint
    )


def plain(term: Term | None) -> str | int | float | bool | None:
    """Return the value of a term as JSON has it: numbers and booleans as such, everything else as text."""
    if not isinstance(term, Literal):
        return None if term is None else term.value if isinstance(term, NamedNode) else str(term)
    datatype = term.datatype.value
    try:
        if datatype in _INTEGERS:
            return int(term.value)
        if datatype in _DECIMALS and term.value not in {"NaN", "INF", "-INF"}:
            return float(term.value)
    except ValueError:
        return term.value
    return term.value in {"true", "1"} if datatype == _XSD + "boolean" else term.value


def display(term: Term | None) -> str:
    """Return a term as people read it: IRIs with known prefixes, literals as their text."""
    if isinstance(term, NamedNode):
        return shorten(term.value).strip("<>")
    if isinstance(term, Literal):
        return term.value
    return "" if term is None else str(term)


def _json_term(term: Term) -> dict[str, object]:
    if isinstance(term, NamedNode):
        return {"type": "uri", "value": term.value}
    if isinstance(term, BlankNode):
        return {"type": "bnode", "value": term.value}
    if isinstance(term, Literal):
        found: dict[str, object] = {"type": "literal", "value": term.value}
        if term.language:
            found["xml:lang"] = term.language
        elif term.datatype.value != _STRING:
            found["datatype"] = term.datatype.value
        return found
    parts = {"subject": term.subject, "predicate": term.predicate, "object": term.object}
    return {"type": "triple", "value": {key: _json_term(part) for key, part in parts.items()}}


def _json(result: Solutions) -> str:
    bindings = [
        {name: _json_term(term) for name, term in zip(result.variables, row, strict=True) if term is not None}
        for row in result.rows
    ]
    content = {"head": {"vars": list(result.variables)}, "results": {"bindings": bindings}}
    return json.dumps(content, ensure_ascii=False, indent=1) + "\n"


def _jsonl(result: Solutions) -> str:
    lines = (dict(zip(result.variables, map(plain, row), strict=True)) for row in result.rows)
    return "".join(json.dumps(line, ensure_ascii=False) + "\n" for line in lines)


def _csv(result: Solutions) -> str:
    output = io.StringIO()
    writer = csv.writer(output, lineterminator="\r\n")
    writer.writerow(result.variables)
    for row in result.rows:
        writer.writerow(["" if term is None else _bare(term) for term in row])
    return output.getvalue()


def _bare(term: Term) -> str:
    return term.value if isinstance(term, NamedNode | Literal) else str(term)


def _tsv(result: Solutions) -> str:
    lines = ["\t".join(f"?{name}" for name in result.variables)]
    # The engine's own form of a term has its tabs and ends of lines escaped.
    lines += [
        "\t".join("" if term is None else _turtle(term).replace("\t", "\\t") for term in row) for row in result.rows
    ]
    return "".join(line + "\n" for line in lines)


def _turtle(term: Term) -> str:
    """Return a term as Turtle writes it, integers and booleans in their short form."""
    if isinstance(term, Literal) and (
        (term.datatype.value == f"{_XSD}integer" and _WHOLE.fullmatch(term.value))
        or (term.datatype.value == f"{_XSD}boolean" and term.value in {"true", "false"})
    ):
        return term.value
    return str(term)


def _xml_term(term: Term) -> str:
    if isinstance(term, NamedNode):
        return f"<uri>{escape(term.value)}</uri>"
    if isinstance(term, BlankNode):
        return f"<bnode>{escape(term.value)}</bnode>"
    if isinstance(term, Literal):
        mark = f" xml:lang={quoteattr(term.language)}" if term.language else ""
        if not mark and term.datatype.value != _STRING:
            mark = f" datatype={quoteattr(term.datatype.value)}"
        return f"<literal{mark}>{escape(term.value, _XML_ESCAPES)}</literal>"
    parts = {"subject": term.subject, "predicate": term.predicate, "object": term.object}
    return "<triple>" + "".join(f"<{key}>{_xml_term(part)}</{key}>" for key, part in parts.items()) + "</triple>"


_XML_ESCAPES: Final = {"\r": "&#13;"}
"""An XML parser reads a bare carriage return as a line feed."""


def _xml_document(head: str, body: str) -> str:
    return f'<?xml version="1.0"?>\n<sparql xmlns="{_NAMESPACE}">\n<head>{head}</head>\n{body}\n</sparql>\n'


def _xml(result: Solutions) -> str:
    head = "".join(f"<variable name={quoteattr(name)}/>" for name in result.variables)
    rows = []
    for row in result.rows:
        pairs = ((name, term) for name, term in zip(result.variables, row, strict=True) if term is not None)
        cells = (f"<binding name={quoteattr(name)}>{_xml_term(term)}</binding>" for name, term in pairs)
        rows.append("<result>" + "".join(cells) + "</result>\n")
    return _xml_document(head, "<results>\n" + "".join(rows) + "</results>")


def _markdown(result: Solutions) -> str:
    lines = ["| " + " | ".join(result.variables) + " |", "|" + " --- |" * len(result.variables)]
    for row in result.rows:
        cells = (display(term).replace("\\", "\\\\").replace("|", "\\|").replace("\n", " ") for term in row)
        lines.append("| " + " | ".join(cells) + " |")
    return "".join(line + "\n" for line in lines)


def _truth(value: bool) -> str:  # noqa: FBT001 - the one thing that is written
    return "true" if value else "false"


SOLUTION_FORMATS: Final[dict[str, Callable[[Solutions], str]]] = {
    "json": _json,
    "xml": _xml,
    "csv": _csv,
    "tsv": _tsv,
    "markdown": _markdown,
    "jsonl": _jsonl,
}
"""What rows can be written as."""

BOOLEAN_FORMATS: Final[dict[str, Callable[[bool], str]]] = {
    "json": lambda value: json.dumps({"head": {}, "boolean": value}) + "\n",
    "xml": lambda value: _xml_document("", f"<boolean>{_truth(value)}</boolean>"),
    "csv": lambda value: f"{_truth(value)}\r\n",
    "tsv": lambda value: f"{_truth(value)}\n",
    "markdown": lambda value: f"{_truth(value)}\n",
    "jsonl": lambda value: f"{_truth(value)}\n",
}
"""What yes or no can be written as."""

GRAPH_FORMATS: Final = {
    "turtle": RdfFormat.TURTLE,
    "ntriples": RdfFormat.N_TRIPLES,
    "nquads": RdfFormat.N_QUADS,
    "trig": RdfFormat.TRIG,
    "jsonld": RdfFormat.JSON_LD,
    "rdfxml": RdfFormat.RDF_XML,
}
"""What a graph can be written as."""
