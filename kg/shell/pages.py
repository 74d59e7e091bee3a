"""Pages as trees of lines: a row of a result, a thing, a node, a proof; their content comes from views."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from kg.render.text import count
from kg.views.wording import quoted

Fact: TypeAlias = tuple[str, str, str]
"""Subject, predicate and object for the view `why`."""


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a page: `iri` is the thing it names, `place` its source, `fact` its triple.

    `mark` follows the text, for inferred facts; `note` is less important. `children` are below it.
    """

    text: str
    iri: str = ""
    place: Mapping[str, Any] | None = None
    fact: Fact | None = None
    mark: str = ""
    note: str = ""
    children: tuple[Line, ...] = ()
    open: bool = True


@dataclass(frozen=True, slots=True)
class Page:
    """The content of a page: `view` and `arguments` are requested when it is shown, `lines` are available at once.

    `query` is SPARQL for the same facts, for a buffer.
    """

    title: str
    view: str = ""
    arguments: dict[str, Any] = field(default_factory=dict)
    lines: tuple[Line, ...] = ()
    query: str = ""


def place_words(place: Mapping[str, Any] | None) -> str:
    """Return a short form of a place, `src/talker.cpp:12`."""
    if not place:
        return ""
    return f"{place['path']}:{place['line']}" if place.get("line") else str(place["path"])


def _section(title: str, lines: Iterable[Line], *, opened: bool = True) -> list[Line]:
    found = tuple(lines)
    return [Line(f"{title} ({len(found)})", children=found, open=opened)] if found else []


def _fact(found: Mapping[str, str] | None) -> Fact | None:
    if found is None:
        return None
    return (f"<{found['subject']}>", f"<{found['predicate']}>", f"<{found['object']}>")


def _inferred(mark: object) -> str:
    return "inferred" if mark else ""


def lines_of_node(found: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the page of a node from the view `node`."""
    about = [
        Line(f"{found['kind']} in {found['language']}, ROS {found['ros']}", place=found["evidence"]),
        Line(f"package {found['package']['name']}", iri=found["package"]["iri"]),
        Line(f"repository {found['repository']['name']}", iri=found["repository"]["iri"], note=found["commit"] or ""),
        *([Line(f"start: {found['start']}")] if found["start"] else []),
        *([] if found["functions"] else [Line("function: unknown")]),
    ]
    classes = [
        line
        for kind in ("functions", "capabilities", "hardware", "devices")
        for line in _section(
            kind.capitalize(),
            (
                Line(
                    one["label"],
                    iri=one["iri"],
                    fact=_fact(one["fact"]),
                    mark=_inferred(one["inferred"]),
                    note=one["grade"],
                )
                for one in found[kind]
            ),
        )
    ]
    return (
        *about,
        *_section("Interfaces", map(_interface, found["interfaces"])),
        *_section("Descriptions", (Line(one["text"], place=one["evidence"]) for one in found["descriptions"][:5])),
        *classes,
        *_section("Parameters", map(_parameter, found["parameters"]), opened=False),
        *_section("Connected to", map(_neighbours, found["neighbours"])),
        *_section(
            "Used in",
            (
                Line(f"{one['name']} in {one['system']}", iri=one["instance"], place=one["evidence"])
                for one in found["used_in"]["instances"]
            ),
            opened=False,
        ),
    )


def _interface(one: Mapping[str, Any]) -> Line:
    name = one.get("resolved") or one.get("name") or one.get("written") or "(unknown)"
    text = f"{one['title']} {name}" + (f"  [{one['type']}]" if one.get("type") else "")
    mark = _inferred(one["fact"])
    return Line(text, one["channel_iri"] or one["iri"] or "", one["evidence"], _fact(one["fact"]), mark, one["how"])


def _parameter(one: Mapping[str, Any]) -> Line:
    words = str(one.get("name") or "(unknown name)")
    if one.get("default") is not None:
        words += f" = {one['default']}"
    return Line(words, one["iri"] or "", one["evidence"], note=one["does"] if isinstance(one["does"], str) else "")


def _neighbours(one: Mapping[str, Any]) -> Line:
    arrow = "→" if one["outward"] else "←"
    below = tuple(Line(f"{node['package']}/{node['name']}", iri=node["iri"]) for node in one["nodes"])
    more = f"{one['count']} nodes, {len(below)} shown" if one["count"] > len(below) else ""
    return Line(f"{arrow} {one['channel']}", iri=one["channel_iri"], note=more, children=below)


def title_of(view: str, found: Mapping[str, Any]) -> str:
    """Return the title of a loaded page; empty if it keeps its name."""
    if view == "node":
        return f"{found['name']}, node of {found['package']['name']}"
    return str(found["label"]) if view == "resource" else ""


def lines_of_resource(found: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the page of a thing from the view `resource`."""
    comment = [Line(found["comment"])] if found["comment"] else []
    uses = [Line(f"the property of {count(found['uses'], 'fact')}")] if found["uses"] else []
    groups = [_group(one, outward=side == "out") for side in ("out", "in") for one in found[side]]
    return (Line(found["short"], place=found["evidence"]), *comment, *uses, *groups)


def _group(one: Mapping[str, Any], *, outward: bool) -> Line:
    """Return the facts of one property; those with the thing as the object are read backwards."""
    label, shown = one["predicate"]["label"], tuple(map(_resource_fact, one["facts"]))
    number = f"{one['count']:,}" + (f", {len(shown)} shown" if one["count"] > len(shown) else "")
    text = f"{label} ({number})" if outward else f"is {label} of ({number})"
    return Line(text, iri="", children=shown)


def _resource_fact(one: Mapping[str, Any]) -> Line:
    value, fact = one["value"], one["fact"]
    text = value["label"] if "iri" in value else value["text"]
    parts = (fact["subject"], fact["predicate"], fact["object"])
    return Line(text, value.get("iri", ""), one["evidence"], parts, _inferred(one["inferred"]), value.get("kind", ""))


def lines_of_system(
    system: Mapping[str, Any], started: Iterable[Mapping[str, Any]], findings: Mapping[str, Any]
) -> tuple[Line, ...]:
    """Return the findings and nodes of a launch configuration, from the views `systems`, `tree`, `lint`."""
    nodes = (Line(one["label"], iri=one.get("node") or one["iri"] or "", note=one["detail"]) for one in started)
    found = [_finding(one) for one in findings["findings"]]
    allowed = [Line(f"{findings['allowed']} more are allowed")] if findings["allowed"] else []
    return (
        Line(f"{system['name']}, ROS {system['ros']}", iri=system["iri"], note=system["repository"]),
        *_section("Findings", found),
        *([] if found else [Line("kg lint found no problems.")]),
        *allowed,
        *_section("Starts", nodes),
    )


def _finding(one: Mapping[str, Any]) -> Line:
    places = tuple(
        Line(place["words"] or place["line_text"] or place_words(place), place=place, note=place["chain"] or "")
        for place in one["evidence"]
    )
    hints = tuple(Line(text) for text in (one["hint"], one["way_out"]) if text)
    text = f"{one['severity']} {one['code']}: {one['message']}"
    return Line(text, place=one["place"], fact=_fact(one["fact"]), children=(*places, *hints), open=False)


def lines_of_proof(found: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the proofs of the view `why`, each down to the lines of code."""
    more = "more than " if found["more_ways"] else ""
    ways = [Line(f"one of {more}{found['ways']} ways")] if found["ways"] > 1 else []
    return (*(_proof(one) for one in found["proofs"]), *ways)


def lines_of_row(found: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the proof of a row."""
    conditions = (Line(f"where {text}") for text in found["conditions"])
    remarks = [Line(found["remark"])] if found["remark"] else []
    return tuple(_section("Rests on", [*map(_proof, found["proofs"]), *conditions, *remarks]))


def _proof(one: Mapping[str, Any]) -> Line:
    fact = (one["subject"]["term"], one["predicate"]["term"], one["object"]["term"])
    if not one["inferred"]:
        return Line(one["text"], place=one["evidence"], fact=fact, note=quoted(one))
    rule = one["rule"]
    note = "proven above" if one["again"] else ""
    because = Line(f"by rule {rule['name']}: {rule['title']}", place=rule["evidence"])
    conditions = (
        Line(
            f"where {told['text']}",
            children=tuple(Line(fact["text"], place=fact["evidence"]) for fact in told["facts"]),
            open=False,
        )
        for told in one["conditions"]
    )
    below = (because, *map(_proof, one["premises"]), *conditions)
    return Line(one["text"], fact=fact, mark="inferred", note=note, children=below)
