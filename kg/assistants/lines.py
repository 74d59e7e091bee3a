"""Answers of views as lines for who reads them by the token: one line for each fact, with the place that states it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import Any, Final

from kg.render.text import NAME_UNKNOWN, TYPE_UNKNOWN
from kg.views.wording import quoted

FURTHER: Final = "`page` {}"
"""The next page of the answer of a tool."""
_TEXTS: Final = 2  # so many descriptions of a node are shown without detail
_WORDS: Final = 200  # characters of a description that are shown without detail


class Where:
    """Writes places as `FILE:LINE`, by paths within their source, and notes where the first source is.

    Places of other sources have the name of theirs in front.
    """

    def __init__(self) -> None:
        self._source: str | None = None
        self.legend: list[str] = []
        """Where the paths without a source are."""

    def __call__(self, evidence: dict[str, Any] | None) -> str:
        """Return a place, as `kg.views.evidence` makes it; empty without one."""
        if not evidence:
            return ""
        path, source = evidence["path"], evidence["repository"] or ""
        text = f"{path}:{evidence['line']}" if evidence.get("line") else str(path)
        if not source:
            return text
        if self._source is None:
            self._source, file = source, evidence.get("file")
            if file and file.endswith(f"/{path}"):
                self.legend.append(f"paths are below {file.removesuffix(path)}")
            elif evidence.get("commit"):
                self.legend.append(f"paths are of {source} at commit {evidence['commit'][:12]}")
        return text if source == self._source else f"{source} {text}"


def node(data: dict[str, Any], where: Where, *, detail: bool) -> Iterator[str]:
    """Yield what is known of a node type (view `node`)."""
    ros = f", ROS {data['ros']}" if data["ros"] else ""
    yield _line(
        f"{data['package']['name']}/{data['name']}: {data['language']} {data['kind']}{ros}",
        data["repository"]["name"],
        where(data["evidence"]),
    )
    if data["start"]:
        yield f"start: {data['start']}"
    for kind in ("functions", "hardware", "devices", "capabilities"):
        plain = detail or kind != "capabilities"
        shown = [one for one in data[kind] if plain or (one["evidence"] and one["grade"] != "weak")]
        if shown:
            graded = (f"{one['label']} ({one['grade']})" if one["grade"] else str(one["label"]) for one in shown)
            yield f"{kind}: {'; '.join(graded)}"
    for one in data["descriptions"][: None if detail else _TEXTS]:
        text = one["text"] if detail or len(one["text"]) <= _WORDS else f"{one['text'][:_WORDS]}..."
        yield _line(f"{one['kind']}: {' '.join(text.split())}", where(one["evidence"]))
    left_out = 0
    for one in data["interfaces"]:
        if one["implicit"] and not detail:
            left_out += 1
            continue
        yield _line(
            one["role"].replace("_", " "),
            one["name"] or f"{NAME_UNKNOWN}: {one['written']}",
            one["type"] or TYPE_UNKNOWN,
            one["how"],
            where(one["evidence"]),
            _code(one, detail=detail),
        )
    if left_out:
        yield f"and {left_out} interfaces that frameworks create"
    for one in data["slots"]:
        yield _line("plugin", one.get("name") or one.get("base_class") or "", where(one["evidence"]))
    for one in data["parameters"]:
        default = f"= {one['default']}" if one.get("default") is not None else ""
        yield _line("parameter", one["name"] or NAME_UNKNOWN, one["type"] or "", default, where(one["evidence"]),
                    _code(one, detail=detail))  # fmt: skip
    for one in data["neighbours"] if detail else ():
        names = ", ".join(f"{other['package']}/{other['name']}" for other in one["nodes"])
        yield f"{one['kind']} {one['channel']} {'to' if one['outward'] else 'from'} {one['count']}: {names}"
    for one in data["used_in"]["instances"]:
        yield _line("started as", one["name"], "in", one["system"], where(one["evidence"]))


def nodes(data: dict[str, Any], _where: Where, *, detail: bool) -> Iterator[str]:
    """Yield the names of the nodes of each package (view `list` of nodes), all of them whatever `detail` is."""
    del detail
    packages: defaultdict[str, list[str]] = defaultdict(list)
    for one in data["rows"]:
        packages[one["package"]].append(one["node"])
    for package in sorted(packages):
        yield f"{package}: {', '.join(sorted(packages[package]))}"
    if data["total"] > len(data["rows"]):
        yield f"{data['total']} nodes in all; `find_nodes` with `package` lists others"


def systems(data: dict[str, Any], _where: Where, *, detail: bool) -> Iterator[str]:
    """Yield the launch files of a store (view `systems`); those that others include only with `detail`."""
    for one in data["systems"]:
        if one["included"] and not detail:
            continue
        wrong = ", ".join(
            f"{number} {severity}{'' if number == 1 else 's'}"
            for severity, number in (one.get("findings") or {}).items()
        )
        counts = ", ".join(f"{one[kind]} {kind}" for kind in ("nodes", "topics", "services", "actions"))
        yield _line(one["name"], f"ROS {one['ros']}", counts, wrong, one["repository"])


def system(data: dict[str, Any], where: Where, *, detail: bool) -> Iterator[str]:
    """Yield what a launch file starts, and the channels between (view `system`)."""
    yield _line(data["name"], f"ROS {data['ros']}", where(data["evidence"]))
    yield from findings({"findings": data["findings"]}, where, detail=detail)
    ends: defaultdict[str, list[str]] = defaultdict(list)
    types: dict[str, str] = {}
    for one in data["instances"]:
        starts = one["starts"] or one["missing"] or "(node not known)"
        yield _line("starts", one["name"], starts, one["condition"] or "", where(one["evidence"]))
        for end in one["ends"]:
            if end["debug"] and not detail:
                continue
            place = f" {where(end['evidence'])}" if detail else ""
            ends[end["channel"]].append(f"{one['name']} {end['role'].replace('_', ' ')}{place}")
            types[end["channel"]] = end["type"] or ""
    for name in sorted(ends):
        yield _line(name, types[name], f": {'; '.join(ends[name])}")
    for one in data["settings"] if detail else ():
        yield _line("sets", one["name"], f"= {one['value']}", where(one["evidence"]))


def channel(data: dict[str, Any], where: Where, *, detail: bool) -> Iterator[str]:
    """Yield the ends of a topic, service or action (view `channel`)."""
    if not data["name"]:
        yield from (f"may be {name}" for name in data["meant"])
        return
    launches = data["systems"]
    yield _line(data["kind"], data["name"], ", ".join(data["types"]), f"in {len(launches)} launch files")
    yield from (f"defined at {where(one)}" for one in data["definitions"])
    for one in data["endpoints"]:
        started = f"started {where(one['launched'])}" if one.get("launched") else ""
        alone = f"perhaps, as {one['name'] or 'an unknown name'}" if one.get("possible") else "in code"
        yield _line(
            one["role"].replace("_", " "),
            one.get("instance") or alone,
            f"{one['package']}/{one['node']}",
            one.get("quality") or "",
            where(one["evidence"]),
            started,
            f"in {', '.join(one['systems'])}" if detail else "",
        )
        yield from (f"  does not fit: {message}" for message in one["mismatches"])


def parameter(data: dict[str, Any], where: Where, *, detail: bool) -> Iterator[str]:
    """Yield the declarations and values of a parameter (view `parameter`)."""
    if not data["name"]:
        yield from (f"may be {name}" for name in data["meant"])
        return
    for one in data["declared"]:
        default = f"= {one['default']}" if one["default"] is not None else ""
        name = f"{one['package']}/{one['node']} {one['name'] or data['name']}"
        yield _line("declared", name, one["type"] or "", default, where(one["evidence"]))
    for one in data["values"]:
        value = one["value"] if one["value"] is not None else f"not known: {one['reason']}"
        yield _line(
            "value",
            one["parameter"],
            f"= {value}",
            where(one["set_at"]) or "the default",
            f"in {', '.join(one['systems'])}" if detail else "",
        )


def findings(data: dict[str, Any], where: Where, *, detail: bool) -> Iterator[str]:
    """Yield what is wrong in launch files (view `lint`); evidence and remedy only with `detail`."""
    for one in data["findings"]:
        yield _line(one["severity"], one["code"], one["message"], where(one["place"]))
        if detail:
            yield f"  remedy: {one['way_out']}"
            yield from (f"  see {where(other)}" for other in one["evidence"])


def hits(data: dict[str, Any], where: Where, *, detail: bool) -> Iterator[str]:
    """Yield nodes that were found (view `find`), each with its best reasons."""
    yield from data["unknown"]
    if data["hits"] and not data["fits"]:
        yield "nothing here fits; nearest are"
    for one in data["hits"]:
        ros = f"ROS {one['ros']}" if one["ros"] else ""
        yield _line(f"{one['rank']}. {one['package']}/{one['name']}", one["kind"], ros, where(one["evidence"]))
        for reason in one["reasons"][: None if detail else 2]:
            yield _line(f"  {reason['text']}", where(reason["evidence"]))
    if data["total"] > len(data["hits"]):
        yield f"{data['total']} hits in all; `limit` shows more"
    if not data["hits"]:
        yield f"no node fits. {data['advice']}"


def impact(data: dict[str, Any], _where: Where, *, detail: bool) -> Iterator[str]:
    """Yield what breaks if a name changes (view `impact`)."""
    yield f"{data['kind']} {data['name']}: {data['breaks']} places break, {data['may']} may break"
    for one in data["effects"]:
        place = f"{one['file']}:{one['line']}" if one.get("line") else one.get("file") or ""
        systems_ = f"in {', '.join(one['systems'])}" if detail and one.get("systems") else ""
        yield _line(one["grade"], one["what"], one.get("reason") or "", place, systems_)


def capabilities(data: dict[str, Any], _where: Where, *, detail: bool) -> Iterator[str]:
    """Yield what a launch file or package can do (view `capabilities`)."""
    yield f"{data['of']} can:"
    for one in data["capabilities"]:
        ways = [f"{way['kind']} {way['name']}" for way in one["ways"]]
        yield _line(one["modality"], one["name"], f"({one['label']})", "; ".join(ways if detail else ways[:1]))


def proofs(data: dict[str, Any], where: Where, *, detail: bool) -> Iterator[str]:
    """Yield why a fact holds (view `why`): each fact with its rule or its place, indented below what it proves."""
    for proof in data["proofs"]:
        yield from _proof(proof, where, 0, detail=detail)
    if data["ways"] > 1:
        more = "or more " if data["more_ways"] else ""
        yield f"{data['ways']} {more}ways lead to it"


def _proof(fact: dict[str, Any], where: Where, depth: int, *, detail: bool) -> Iterator[str]:
    rule = fact.get("rule")
    by = f"by rule {rule['name']} {where(rule['evidence'])}" if rule else where(fact.get("evidence"))
    code = "" if rule else _code(fact, detail=detail)
    yield _line(f"{'  ' * depth}{fact['text']}", by, "(as above)" if fact.get("again") else "", code)
    if rule and detail:
        bound = ", ".join(f"?{one['name']} = {one['label']}" for one in fact["bindings"])
        yield f"{'  ' * depth}  with {bound}"
    for premise in fact.get("premises") or ():
        yield from _proof(premise, where, depth + 1, detail=detail)
    for condition in fact.get("conditions") or ():
        yield f"{'  ' * (depth + 1)}{condition['text']}"
        for one in condition.get("facts") or ():
            yield _line(f"{'  ' * (depth + 2)}{one['text']}", where(one.get("evidence")))


def lacking(data: dict[str, Any], where: Where, *, detail: bool, depth: int = 0) -> Iterator[str]:
    """Yield why a fact does not hold (view `why_not`): what each rule that could derive it lacks."""
    indent = "  " * depth
    if not depth:
        yield f"{data['fact']['text']} does not hold"
    for one in data["attempts"]:
        yield _line(f"{indent}rule {one['rule']['name']}", one["fails"], where(one["rule"]["evidence"]))
        for near in (one.get("nearest") or ())[: None if detail else 1]:
            yield f"{indent}  nearest: {near}"
        if one.get("deeper") and (detail or not depth):
            yield from lacking(one["deeper"], where, detail=detail, depth=depth + 1)


def _code(one: dict[str, Any], *, detail: bool) -> str:
    """Return the line of code; without `detail` only where it is from the store, as its file cannot be opened."""
    code = quoted(one) if detail or one.get("line_stored") else ""
    return f"`{code}`" if code else ""


def _line(*parts: str) -> str:
    return "  ".join(part for part in parts if part)


def paged(lines: Iterable[str], legend: list[str], page: int, size: int, *, further: str = FURTHER) -> str:
    """Return a page of lines of at most `size` bytes, with a line about the others; pages count from 1.

    A line that is longer than a page is cut. Every page ends with the legend. `further` names the page of a number.
    """
    tail = "\n".join(legend)
    room = max(size - len(tail.encode()) - 100, 200)
    pages: list[list[str]] = [[]]
    used = 0
    for line in lines:
        content = line.encode()
        if len(content) > room:
            line, content = content[: room - 4].decode(errors="ignore") + " ...", content[:room]  # noqa: PLW2901 - cut
        if used + len(content) + 1 > room and pages[-1]:
            pages.append([])
            used = 0
        pages[-1].append(line)
        used += len(content) + 1
    if page > len(pages):
        return f"page {page} does not exist; the answer has {len(pages)}"
    next_page = further.format(page + 1)
    more = [f"page {page} of {len(pages)}; continue with {next_page}"] if page < len(pages) else []
    if len(pages) > 1 and not more:
        more = [f"page {page} of {len(pages)}"]
    return "\n".join([*pages[page - 1], *more, *legend])
