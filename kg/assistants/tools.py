"""The tools that an assistant may call; their docstrings are what it reads."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from mcp.server.mcpserver.exceptions import ToolError
from pydantic import Field

from kg.assistants.compact import compact
from kg.errors import KgError
from kg.query.readers.messages import Question

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from kg.query.readers.pool import Readers

__all__ = ["Tools"]

_FORMATS: Final = {"rows": "jsonl", "boolean": "json", "graph": "turtle"}
_MOST_ROWS: Final = 200
_MOST_HITS: Final = 50
_DOES_NOT_HOLD: Final = "KG226"

Names = Annotated[
    list[str] | None,
    Field(description="Message, service or action types or names, e.g. sensor_msgs/LaserScan or /scan."),
]
Words = Annotated[
    list[str] | None, Field(description="Names as kg knows them; an unknown one is an error with suggestions.")
]
System = Annotated[str, Field(description="A launch file as `wiring` lists them without arguments.")]


class Tools:
    """What is answered about one store; `seconds` is the deadline of each answer."""

    def __init__(self, seconds: float | None) -> None:
        self._seconds = seconds
        self.readers: Readers | None = None
        """The readers, while the server runs."""

    @property
    def all(self) -> tuple[Callable[..., Coroutine[Any, Any, Any]], ...]:
        """The tools in the order that they are listed."""
        return (self.find_nodes, self.describe_node, self.wiring, self.ends_of, self.lint, self.query, self.explain)

    async def find_nodes(  # noqa: PLR0913 - what may be asked for, each by its name
        self,
        *,
        need: Annotated[str, Field(description="What the node has to do, in plain words; may be empty.")] = "",
        subscribes: Names = None,
        publishes: Names = None,
        hardware: Words = None,
        function: Words = None,
        package: Words = None,
        ros: Annotated[int | None, Field(description="1 or 2")] = None,
        limit: Annotated[int, Field(ge=1, le=_MOST_HITS)] = 10,
    ) -> dict[str, Any]:
        """Find ROS nodes by what they do, what they subscribe and publish, and the hardware they work with.

        Answers ranked nodes with the reasons they match; each reason ends in the line of code or text it comes from.
        Use it before writing a node: one may exist.
        """
        given: dict[str, list[str] | None] = {
            "subscribes": subscribes,
            "publishes": publishes,
            "hardware": hardware,
            "function": function,
            "package": package,
            "ros": None if ros is None else [str(ros)],
        }
        filters = {name: ",".join(values) for name, values in given.items() if values}
        return await self._view("find", text=need, limit=str(limit), **filters)

    async def describe_node(
        self,
        name: Annotated[str, Field(description="The node's name, `package/node`, or its IRI.")],
        package: Annotated[str, Field(description="Its package, where several nodes have the name.")] = "",
    ) -> dict[str, Any]:
        """Describe one ROS node: topics, services, actions, parameters with types and QoS, purpose, hardware, start.

        Each fact has the line of code that states it. Members marked `inferred` follow by rules: `explain` proves them.
        """
        if "://" in name:
            return await self._view("node", iri=name)
        return await self._view("node", name=name, package=package)

    async def wiring(self, system: System = "") -> dict[str, Any]:
        """Show what a launch file starts: nodes with resolved names, the topics and services between them, findings.

        Without `system`, list the launch files of the store.
        """
        if not system:
            return await self._view("systems")
        found = await self._view("system", name=system)
        found.pop("picture", None)  # the same again, to be drawn
        return found

    async def ends_of(
        self,
        name: Annotated[str, Field(description="/cmd_vel, a name in the code (cmd_vel, ~/plan), or a part of a name.")],
        kind: Annotated[
            Literal["topic", "service", "action", "parameter"], Field(description="What it names.")
        ] = "topic",
        system: System = "",
    ) -> dict[str, Any]:
        """Show who uses a topic, service or action, or what sets a parameter, in all launch files and in code.

        Each end has its node, launch line, line of code, type and QoS; `mismatches` says where ends do not fit.
        Where several names are meant, they are listed.
        """
        if kind == "parameter":
            return await self._view("parameter", name=name, system=system)
        return await self._view("channel", kind=kind, name=name, system=system)

    async def lint(
        self, system: System = "", package: Annotated[str, Field(description="Only launch files of this package.")] = ""
    ) -> dict[str, Any]:
        """Report what is wrong in the wiring of launch files: topic typos, type and QoS clashes, missing publishers.

        Each finding has a code, the place, and its evidence.
        """
        return await self._view("lint", system=system, package=package)

    async def query(
        self,
        sparql: Annotated[str, Field(description="A SPARQL 1.1 query; the prefixes ros:, rnkg:, rdfs: ... are known.")],
        limit: Annotated[int, Field(ge=1, le=_MOST_ROWS)] = 50,
    ) -> dict[str, Any]:
        """Run a read-only SPARQL query over everything that is known.

        Classes: rnkg:NodeType, rnkg:Package, ros:Topic, ros:Service, ros:Message ... Properties of nodes:
        rnkg:publishes, rnkg:subscribes, rnkg:hasFunction, rnkg:usesHardware, rnkg:hasCapability; places: rnkg:path,
        rnkg:line. For example: SELECT ?node ?topic { ?node rnkg:publishes/rdfs:label ?topic } .
        """
        question = Question(text=sparql, formats=_FORMATS, rows=limit)
        try:
            async with self._open.ask(question, seconds=self._seconds) as answer:
                body = b"".join([part async for part in answer.parts()]).decode()
        except KgError as error:
            raise _told(error) from error
        end = answer.end
        found: dict[str, Any] = {"snapshot": answer.head.snapshot, "more": bool(end and end.more)}
        if answer.head.kind == "rows":
            return {**found, "rows": [json.loads(line) for line in body.splitlines()]}
        if answer.head.kind == "boolean":
            return {**found, "answer": json.loads(body)["boolean"]}
        return {**found, "turtle": body}

    async def explain(
        self,
        subject: Annotated[str, Field(description="A name in the store, a prefixed name, or an IRI.")],
        predicate: Annotated[str, Field(description="A property, e.g. hasFunction, rnkg:usesHardware or an IRI.")],
        value: Annotated[str, Field(description="A name in the store, a prefixed name, a literal, or an IRI.")],
    ) -> dict[str, Any]:
        """Explain why a fact holds: the rules that derive it and the facts they read, down to the line of code.

        Where it does not hold, answers what each rule that could derive it lacks, with the nearest match.
        """
        fact = {"subject": subject, "predicate": predicate, "object": value}
        try:
            return await self._answer("why", fact)
        except KgError as error:
            if error.code != _DOES_NOT_HOLD:
                raise _told(error) from error
        return {"holds": False, **await self._view("why_not", **fact)}

    async def _view(self, view: str, /, **arguments: Any) -> dict[str, Any]:
        try:
            return await self._answer(view, arguments)
        except KgError as error:
            raise _told(error) from error

    async def _answer(self, view: str, arguments: dict[str, Any]) -> dict[str, Any]:
        found = compact(json.loads(await self._open.call(view, arguments, seconds=self._seconds)))
        return found if isinstance(found, dict) else {view: found}

    @property
    def _open(self) -> Readers:
        if self.readers is None:
            raise ToolError("the server is not running")
        return self.readers


def _told(error: KgError) -> ToolError:
    """Return an error as the assistant reads it, with the way out."""
    return ToolError(f"{error}. {error.hint}" if error.hint else str(error))
