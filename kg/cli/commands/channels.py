"""`kg topic`, `service`, `action` and `param`: one name with its ends or values, in launched systems and in code."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final

from kg.cli import completion
from kg.cli.commands.lists import channel_rows
from kg.cli.completion import parameters
from kg.cli.diagnostics import note
from kg.cli.options import Json, System, Via, argument, option, with_settings
from kg.cli.output import Column, Linked, fitted, json_lines, line_width, listing, make_table, show, terminal
from kg.lazily import lazily
from kg.render.system_notations import NOBODY
from kg.render.text import VALUE_UNKNOWN, count, printable, some
from kg.settings import Settings
from kg.store.opening import reading

if TYPE_CHECKING:
    from rich.console import RenderableType


with lazily():
    from rich.text import Text

    from kg.cli.links import Links
    from kg.facts import Location
    from kg.views.channel import channel
    from kg.views.evidence import places
    from kg.views.parameter import parameter


_OF_FACES: Final = frozenset({"accesses", "calls", "doubt", "evidence", "node_iri", "quality", "title"})
"""Fields of a row for pages only; other fields have the same data."""
_MOST_SYSTEMS: Final = 3  # maximum number of launch files listed in a sentence
_MOST_STARTS: Final = 3  # maximum number of rows for the starts of one node that are otherwise equal
_SHOWN: Final = (
    *("title", "instance", "package", "node", "plugins", "types", "quality", "evidence", "calls"),
    *("value", "set_at"),
)
"""Fields of a row that are shown, apart from the launch line and the launch files."""


def endpoint_view(
    channel: "Mapping[str, Any]", links: "Links", columns: int, *, every: bool, via: bool
) -> "Iterator[RenderableType]":
    """Yield the output for the view `channel` at a width in columns.

    `every` gives each launch file a row, `via` adds the calls from a line to the framework.
    """
    ends = channel["endpoints"]
    qualities = {one["quality"] for one in ends if not one.get("possible")}
    yield Text.assemble((printable(channel["name"]), "bold"), f"  {channel['kind']}  {', '.join(channel['types'])}")
    where = f"in {count(len(channel['systems']), 'launch file')}" if channel["systems"] else "in no launch file"
    conditional = any(one["switches"] or one["doubt"] for one in ends)
    same = f"; QoS {''.join(qualities)}" if len(qualities) == 1 and qualities != {""} and not conditional else ""
    yield Text(f"  {where}; {_fit(channel)}{same}", style="dim")
    if channel["definitions"]:
        yield Text(f"  defined at {', '.join(map(_place, channel['definitions']))}", style="dim")
    yield Text()
    titles = {
        "node": Column("node", "name"),
        "of": Column("of", spare=4),
        "type": Column("type", spare=2) if len(channel["types"]) > 1 else None,
        "QoS": Column("condition, QoS" if conditional else "QoS", spare=3)
        if len(qualities) > 1 or conditional
        else None,
        "started": Column("started at", "dim"),
        "in": Column("launch file") if every else Column("in", spare=1),
        "code": Column("code", "dim"),
    }
    shown_ends = ends if every else list(_folded({**one, "set_at": None} for one in ends))
    places = _Places(links, columns, shown_ends, ("evidence", "launched"))
    rows = list(_endpoints(shown_ends, places, every=every, via=via))
    shown = {name: column for name, column in titles.items() if column and any(row.get(name) for row in rows)}
    yield make_table(tuple(shown.values()), [[row.get(name, "") for name in shown] for row in rows])
    yield from _hidden_rows(ends, shown_ends)
    if channel["findings"]:
        yield Text()
    for one in channel["findings"]:
        yield Text.assemble((f"{one['severity']}[{one['code']}]", "bold"), f": {printable(one['message'])}")
        systems = one["systems"]
        more = f" and {count(len(systems) - _MOST, 'other launch file')}" if len(systems) > _MOST_SYSTEMS else ""
        yield Text(f"  in {', '.join(systems[:_MOST])}{more}", style="dim")


def parameter_view(
    parameter: "Mapping[str, Any]", links: "Links", columns: int, *, every: bool, via: bool
) -> "Iterator[RenderableType]":
    """Yield the output for the view `parameter` at a width in columns; see `endpoint_view`."""
    yield Text.assemble((printable(parameter["name"]), "bold"), "  parameter")
    values = parameter["values"] if every else list(_folded(parameter["values"]))
    place = _Places(links, columns, [*parameter["declared"], *values], ("evidence", "set_at", "launched"))
    if parameter["declared"]:
        yield Text()
        rows = [row for one in parameter["declared"] for row in _declared(one, place, via=via)]
        titles = (Column("declared by", "name"), Column("type"), Column("default"), Column("code does", spare=1))
        yield make_table((*titles, Column("code", "dim")), rows)
    if values:
        yield Text()
        rows = [row for one in values for row in _value(one, place, every=every)]
        named = Column("launch file") if every else Column("in", spare=1)
        titles = (
            Column("node", "name"),
            Column("value"),
            Column("set at", "dim"),
            Column("started at", "dim", spare=2),
        )
        yield make_table((*titles, named), rows)
        yield from _hidden_rows(parameter["values"], values)


def plain(row: "Mapping[str, Any]") -> dict[str, Any]:
    """Return a row of a view for other programs: without page fields, places as `file`, `line`, `repository`."""
    return {
        name: {"file": value["path"], "line": value["line"], "repository": value["repository"]}
        if isinstance(value, dict) and "vscode" in value
        else value
        for name, value in row.items()
        if name not in _OF_FACES and not (isinstance(value, dict) and "words" in value)
    }


def _fit(channel: "Mapping[str, Any]") -> str:
    sides = {one["role"]: one for one in channel["endpoints"] if one["instance"] is not None}
    if channel["findings"]:
        return f"{count(len(channel['findings']), 'mismatch', 'mismatches')} of types or QoS"
    if len(sides) == 1:
        (role,) = sides
        return NOBODY[channel["kind"], role in {"publishes", "clients", "action_clients"}]
    with_qos = any(one["qos"] for one in sides.values())
    if len(channel["types"]) > 1:
        fit = f"no certain mismatch of {'types or QoS' if with_qos else 'types'}"
    else:
        fit = "types and QoS fit" if with_qos else "types fit"
    return fit if sides else "only code has it"


class _Places:
    """Writes places as cells with links, shortened to fit the width."""

    def __init__(
        self, links: "Links", columns: int, rows: "Sequence[Mapping[str, Any]]", names: "Sequence[str]"
    ) -> None:
        self._links = links
        self._shown: dict[str, str] = {}
        for name in names:
            given = [row[name] for row in rows if row.get(name) and not isinstance(row[name], str)]
            places = list(dict.fromkeys(map(_place, given)))
            self._shown.update(zip(places, fitted(places, columns // 4), strict=True))

    def cell(self, evidence: "Mapping[str, Any] | str | None", words: str = "") -> Linked | str:
        """Return a cell for a place, with `words` before it, or alone without a place; a text is returned as it is."""
        if evidence is None:
            return words
        if isinstance(evidence, str):
            return evidence
        address = self._links.to(evidence["repository"], Location(evidence["path"], evidence["line"] or 0))
        text = _place(evidence)
        return Linked(f"{words}{self._shown.get(text, text)}", address)


def _place(evidence: "Mapping[str, Any]") -> str:
    return f"{evidence['path']}:{evidence['line']}" if evidence["line"] else str(evidence["path"])


def _folded(rows: "Iterable[Mapping[str, Any]]") -> "Iterator[Mapping[str, Any]]":
    """Yield rows, where one row replaces many that look the same but for the launch line and the launch files.

    Its `launched` is the number of launch lines in words.
    """
    groups: dict[str, list[Mapping[str, Any]]] = {}
    for one in rows:
        groups.setdefault(repr([one.get(name) for name in _SHOWN]), []).append(one)
    for group in groups.values():
        lines = {_place(one["launched"]) for one in group if one["launched"]}
        if len(lines) <= _MOST_STARTS:
            yield from group
        else:
            systems = sorted({system for one in group for system in one["systems"]})
            yield {**group[0], "launched": count(len(lines), "launch line"), "systems": systems}


def _hidden_rows(rows: "Sequence[object]", shown: "Sequence[object]") -> "Iterator[RenderableType]":
    if len(shown) < len(rows):
        yield Text("--all shows every launch line", style="dim")


def _endpoints(
    ends: "Iterable[Mapping[str, Any]]", places: "_Places", *, every: bool, via: bool
) -> "Iterator[Mapping[str, object]]":
    """Yield rows by column name; each role has a heading row above its endpoints."""
    title = None
    for one in ends:
        if one.get("possible"):
            head = f"{one['title']}, perhaps: the name is {'partly ' if one['name'] else ''}unknown"
        else:
            head = one["title"] if one["instance"] else f"{one['title']}, not started by a launch file"
        if head != title:
            title = head
            yield {"node": title}
        kind = f"{one['package']}/{one['node']}" if one["package"] else str(one["node"] or "")
        loaded = ", ".join(name.rpartition("/")[2] for name in one["plugins"])
        of = f"{kind if one['instance'] else ''}{f' with {loaded}' if loaded else ''}"
        row = {
            "node": f"  {one['instance'] or kind}",
            "of": of,
            "type": " | ".join(one["types"]),
            "QoS": one["quality"],
            "started": places.cell(one["launched"]),
            "code": places.cell(one["evidence"], f"{one['name']} " if one.get("possible") and one["name"] else ""),
        }
        for system in (one["systems"] if every else ()) or [_count(one["systems"])]:
            yield {**row, "in": system}
        for call in one["calls"] if via else ():
            yield {"code": places.cell(call, "via ")}


def _declared(one: "Mapping[str, Any]", places: "_Places", *, via: bool) -> "Iterator[tuple[object, ...]]":
    node = f"{one['package']}/{one['node']}"
    yield node, one["type"] or "", one["default"] or "", one["accesses"] or "declared", places.cell(one["evidence"])
    for call in one["calls"] if via else ():
        yield "", "", "", "", places.cell(call, "via ")


def _value(one: "Mapping[str, Any]", places: "_Places", *, every: bool) -> "Iterator[tuple[object, ...]]":
    value = VALUE_UNKNOWN if one["value"] is None else one["value"]
    origin = places.cell(one["set_at"], "" if one["set_at"] else "default")
    started = places.cell(one["launched"])
    for system in (one["systems"] if every else ()) or [_count(one["systems"])]:
        yield one["instance"], value, origin, started, system


def _count(systems: "Iterable[str]") -> str:
    every = list(systems)
    return every[0] if len(every) == 1 else count(len(every), "launch file") if every else ""


_MOST = 5  # so many names are listed in a note
_HELP = "Name in a system (`/{0}`), name in the code (`{0}` or `~/{0}`), or a part of either."
All = Annotated[bool, option("--all -a", "Show a row for each launch file.")]


def _command(kind: str, example: str, text: str) -> Callable[..., None]:
    """Return the command that shows one name of a kind; `text` is its manual."""
    name_of_kind = argument("NAME", _HELP.format(example), autocompletion=completion.channels(kind), show_default=False)

    def command(  # noqa: PLR0913 - the options of a command
        name: Annotated[str, name_of_kind],
        *,
        settings: Settings,
        system: System = None,
        every: All = False,
        via: Via = False,
        json: Json = False,
    ) -> None:
        with reading(settings) as snapshot:
            described = channel(snapshot, settings, kind=kind, name=name, system=system or "")
            others = [one["name"] for one in described["meant"]]
            if json:
                names = [described["name"], *others] if described["name"] else others
                for one in names:
                    ends = channel(snapshot, settings, kind=kind, name=one, system=system or "")["endpoints"]
                    json_lines(map(plain, ends))
                return
            links = Links(places(snapshot))
        if described["name"] is None:
            channel_rows(kind, described["meant"])
            is_whole = name.startswith("/") and not name.endswith("/")
            missing = f"no {kind} is called `{name}`; " if is_whole else ""
            matching = f"{count(len(others), kind)} {'begin with it' if is_whole else f'match `{name}`'}"
            note(f"{missing}{matching}; `kg {kind} {others[0]}` shows one")
            return
        show(*endpoint_view(described, links, line_width(), every=every, via=via))
        if others:
            note(f"`{name}` in the code is also {some(others, _MOST)}")

    command.__doc__ = text
    return with_settings("store")(command)


topic = _command(
    "topic",
    "scan",
    """Show a topic's publishers and subscribers, by launch file and in code.

    Each row is one line of code in one start of a node, with its QoS, the line that starts it, and the number of
    launch files that include that line. More than three starts that differ in that line alone are one row. Incompatible
    types and QoS are listed below, as `kg lint` reports them. For example:

        kg topic /cmd_vel
        kg topic cmd_vel --system rover.launch
        kg topic vel --json
    """,
)
service = _command("service", "reset", "Show a service's servers and clients; works like `kg topic`.")
action = _command("action", "dock", "Show an action's servers and clients; works like `kg topic`.")


_PARAMETER_HELP = "Name in the code (`rate`), in a parameter file (`FollowPath.speed`), `/node/rate`, or a part of one."
ParameterName = Annotated[str, argument("NAME", _PARAMETER_HELP, autocompletion=parameters, show_default=False)]


@with_settings("store")
def param(  # noqa: PLR0913 - the options of a command
    name: ParameterName,
    *,
    settings: Settings,
    system: System = None,
    every: All = False,
    via: Via = False,
    json: Json = False,
) -> None:
    """Show the nodes that declare a parameter, and its value per launch file.

    Shows the line of code that declares it, its type and default, and the line of the launch or parameter file that
    sets it. A node started without a value uses the default. For example:

        kg param use_sim_time
        kg param /controller_server/controller_frequency
        kg param speed --system rover.launch --json
    """
    with reading(settings) as snapshot:
        described = parameter(snapshot, settings, name=name, system=system or "")
        if json:
            for one in [described["name"]] if described["name"] else described["meant"]:
                each = parameter(snapshot, settings, name=one, system=system or "")
                json_lines(plain(row) for row in (*each["declared"], *each["values"]))
            return
        links = Links(places(snapshot))
    if described["name"] is None:
        listing((Column("parameter", "name"),), [(one,) for one in described["meant"]])
        if terminal():
            note(f"{count(len(described['meant']), 'parameter')}; `kg param {described['meant'][0]}` shows one")
        return
    show(*parameter_view(described, links, line_width(), every=every, via=via))
