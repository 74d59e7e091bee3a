"""Remarks about lines as SARIF 2.1.0 (OASIS), shown by code hosts, and as annotations of GitHub."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Final

from kg.codes import CATALOGUE, CodeEntry

_SCHEMA: Final = "https://json.schemastore.org/sarif-2.1.0.json"
_KINDS: Final = {"note": "notice"}
"""What GitHub calls a severity, where that is another word."""


@dataclass(frozen=True, slots=True)
class Spot:
    """A line of a file: `uri` is relative to the checked folder, or absolute; `words` describe the line."""

    uri: str
    line: int | None = None
    column: int | None = None
    words: str = ""


@dataclass(frozen=True, slots=True)
class Remark:
    """A remark about a line; `severity` is error, warning or note.

    `related` are supporting lines, `fingerprint` does not change when lines move.
    """

    code: str
    severity: str
    message: str
    spot: Spot
    related: Sequence[Spot] = ()
    fingerprint: str | None = None
    properties: Mapping[str, object] = field(default_factory=dict)


def document(remarks: Sequence[Remark]) -> dict[str, object]:
    """Return remarks as one run of SARIF, with the catalogue's texts for their codes."""
    codes = sorted({remark.code for remark in remarks})
    rules: list[dict[str, object]] = []
    for code in codes:
        entry = CATALOGUE.get(code) or CodeEntry(code, "", "")
        texts = {"shortDescription": entry.title, "fullDescription": entry.explanation, "help": entry.way_out}
        rules.append({"id": code, **{name: {"text": text} for name, text in texts.items() if text}})
    driver = {"name": "kg", "version": version("kg-ros"), "rules": rules}
    results = [_result(remark, codes) for remark in remarks]
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": [{"tool": {"driver": driver}, "results": results}]}


def annotation(remark: Remark) -> str:
    """Return the line that GitHub's runners turn into a remark at the line; lines that have to do with it are named."""
    kind = _KINDS.get(remark.severity, remark.severity)
    related = (f"{one.uri}:{one.line or 1} {one.words}".rstrip() for one in remark.related)
    spot, message = remark.spot, _escaped("\n".join((remark.message, *related)))
    place = f"file={_property(spot.uri)},line={spot.line or 1},col={spot.column or 1}"
    return f"::{kind} {place},title={_property(remark.code)}::{message}"


def _result(remark: Remark, codes: list[str]) -> dict[str, object]:
    result: dict[str, object] = {
        "ruleId": remark.code,
        "ruleIndex": codes.index(remark.code),
        "level": remark.severity,
        "message": {"text": remark.message},
        "locations": [_location(remark.spot)],
    }
    if remark.related:
        result["relatedLocations"] = [_location(spot) for spot in remark.related]
    if remark.fingerprint:
        result["partialFingerprints"] = {"kg/v1": remark.fingerprint}
    if remark.properties:
        result["properties"] = dict(remark.properties)
    return result


def _location(spot: Spot) -> dict[str, object]:
    region = {"startLine": spot.line or 1}
    if spot.column:
        region["startColumn"] = spot.column
    location: dict[str, object] = {"physicalLocation": {"artifactLocation": {"uri": spot.uri}, "region": region}}
    if spot.words:
        location["message"] = {"text": spot.words}
    return location


def _escaped(text: str) -> str:
    """Return a message as workflow commands take it (actions/toolkit, command.ts)."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    """Return the value of a property of a workflow command."""
    return _escaped(text).replace(":", "%3A").replace(",", "%2C")
