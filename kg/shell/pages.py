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
    children = tuple(lines)
    return [Line(f"{title} ({len(children)})", children=children, open=opened)] if children else []


def _fact(fact: Mapping[str, str] | None) -> Fact | None:
    if fact is None:
        return None
    return (f"<{fact['subject']}>", f"<{fact['predicate']}>", f"<{fact['object']}>")


def _inferred(mark: object) -> str:
    return "inferred" if mark else ""


def lines_of_node(node: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the page of a node from the view `node`."""
    about = [
        Line(f"{node['kind']} in {node['language']}, ROS {node['ros']}", place=node["evidence"]),
        Line(f"package {node['package']['name']}", iri=node["package"]["iri"]),
        Line(f"repository {node['repository']['name']}", iri=node["repository"]["iri"], note=node["commit"] or ""),
        *([Line(f"start: {node['start']}")] if node["start"] else []),
        *([] if node["functions"] else [Line("function: unknown")]),
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
                for one in node[kind]
            ),
        )
    ]
    return (
        *about,
        *_section("Interfaces", map(_interface, node["interfaces"])),
        *_section("Descriptions", (Line(one["text"], place=one["evidence"]) for one in node["descriptions"][:5])),
        *classes,
        *_section("Parameters", map(_parameter, node["parameters"]), opened=False),
        *_section("Connected to", map(_neighbours, node["neighbours"])),
        *_section(
            "Used in",
            (
                Line(f"{one['name']} in {one['system']}", iri=one["instance"], place=one["evidence"])
                for one in node["used_in"]["instances"]
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


def title_of(view: str, data: Mapping[str, Any]) -> str:
    """Return the title of a loaded page; empty if it keeps its name."""
    if view == "node":
        return f"{data['name']}, node of {data['package']['name']}"
    return str(data["label"]) if view == "resource" else ""


def lines_of_resource(resource: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the page of a thing from the view `resource`."""
    comment = [Line(resource["comment"])] if resource["comment"] else []
    uses = [Line(f"the property of {count(resource['uses'], 'fact')}")] if resource["uses"] else []
    groups = [_group(one, outward=side == "out") for side in ("out", "in") for one in resource[side]]
    return (Line(resource["short"], place=resource["evidence"]), *comment, *uses, *groups)


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
    finding_lines = [_finding(one) for one in findings["findings"]]
    allowed = [Line(f"{findings['allowed']} more are allowed")] if findings["allowed"] else []
    return (
        Line(f"{system['name']}, ROS {system['ros']}", iri=system["iri"], note=system["repository"]),
        *_section("Findings", finding_lines),
        *([] if finding_lines else [Line("kg lint found no problems.")]),
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


def lines_of_proof(answer: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the proofs of the view `why`, each down to the lines of code."""
    more = "more than " if answer["more_ways"] else ""
    ways = [Line(f"one of {more}{answer['ways']} ways")] if answer["ways"] > 1 else []
    return (*(_proof(one) for one in answer["proofs"]), *ways)


def lines_of_row(answer: Mapping[str, Any]) -> tuple[Line, ...]:
    """Return the proof of a row."""
    conditions = (Line(f"where {text}") for text in answer["conditions"])
    remarks = [Line(answer["remark"])] if answer["remark"] else []
    return tuple(_section("Rests on", [*map(_proof, answer["proofs"]), *conditions, *remarks]))


def _proof(one: Mapping[str, Any]) -> Line:
    fact = (one["subject"]["term"], one["predicate"]["term"], one["object"]["term"])
    if not one["inferred"]:
        return Line(one["text"], place=one["evidence"], fact=fact, note=quoted(one))
    rule = one["rule"]
    note = "proven above" if one["again"] else ""
    because = Line(f"by rule {rule['name']}: {rule['title']}", place=rule["evidence"])
    conditions = (
        Line(
            f"where {condition['text']}",
            children=tuple(Line(fact["text"], place=fact["evidence"]) for fact in condition["facts"]),
            open=False,
        )
        for condition in one["conditions"]
    )
    below = (because, *map(_proof, one["premises"]), *conditions)
    return Line(one["text"], fact=fact, mark="inferred", note=note, children=below)
