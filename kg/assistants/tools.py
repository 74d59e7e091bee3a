"""The tools that an assistant may call; their docstrings are what it reads.

Every answer is text of one line for each fact, at most 3 KB a page, or 12 KB with `detail`.
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import sys
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal
from urllib.parse import quote

from mcp.server.mcpserver import AcceptedElicitation, Context, Elicit, ElicitationResult, Resolve
from mcp.server.mcpserver.exceptions import ToolError
from pydantic import BaseModel, Field

from kg.assistants import lines
from kg.errors import KgError
from kg.query.readers.messages import Question

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Iterable, Iterator

    from kg.query.readers.pool import Readers


_GRACE: Final = 5.0  # seconds that a command has to end by itself, so that a robot that it drives is stopped


async def run_command(*arguments: str, seconds: float) -> tuple[int, str]:
    """Run `kg` with these arguments; return the exit code, and what it wrote on both outputs.

    After `seconds`, or when the call is cancelled, it is interrupted as by Ctrl-C; TimeoutError after `seconds`.
    """
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "kg", *arguments),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        env=os.environ | {"KG_COLOR": "never"},
    )
    try:
        written, _ = await asyncio.wait_for(process.communicate(), seconds)
    finally:
        if process.returncode is None:
            with suppress(ProcessLookupError):
                process.send_signal(signal.SIGINT)
                try:
                    await asyncio.wait_for(process.communicate(), _GRACE)
                except TimeoutError:
                    process.kill()
    return process.returncode or 0, written.decode(errors="replace")


@contextmanager
def program_file(text: str) -> Iterator[tuple[str, str]]:
    """Yield a folder, with a slash at its end, and in it a file with the text of a program; both last as the block."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.kgp"
        path.write_text(text, encoding="utf-8")
        yield f"{folder}/", str(path)


PAGE: Final = 2700
"""Bytes of an answer, or of a page of it: with what the protocol adds, 3 KB."""
_DETAILED: Final = 12_000  # bytes of a page with detail
_FORMATS: Final = {"rows": "tsv", "boolean": "json", "graph": "turtle"}
_MOST_ROWS: Final = 200
_MOST_HITS: Final = 50
_MOST_NODES: Final = 1000
_DOES_NOT_HOLD: Final = "KG226"
_TOO_LONG: Final = "KG503"
_HEADED: Final = 2  # lines of a table with one row: the variables, and the row
_QUERY_SECONDS: Final = 10.0
_DIFF_SECONDS: Final = 300.0
_RUN_SECONDS: Final = 600.0
_ROBOT_SECONDS: Final = 30.0

Names = Annotated[
    list[str] | None,
    Field(description="Message, service or action types or names, e.g. sensor_msgs/LaserScan or /scan."),
]
Words = Annotated[
    list[str] | None, Field(description="Names in the store; an unknown one is an error with suggestions.")
]
System = Annotated[str, Field(description="A launch file as `wiring` lists them without arguments.")]
Detail = Annotated[bool, Field(description="More about each fact, on longer pages.")]
Page = Annotated[int, Field(ge=1, description="Which page of a long answer.")]
Program = Annotated[str, Field(description="The text of a program (.kgp).")]


class _Consent(BaseModel):
    """What a person answers before a robot moves."""

    run: bool = Field(description="Run the program on the robot now?")


async def ask_person(program: str, dry_run: bool, context: Context[Any]) -> _Consent | Elicit[_Consent]:  # noqa: FBT001 - by name
    """Ask a person whether a program may move the robot; ToolError where nobody can be asked."""
    if dry_run:
        return _Consent(run=False)
    capabilities = context.client_capabilities
    if capabilities is None or capabilities.elicitation is None:
        raise ToolError(
            "no person can be asked: this client does not support elicitation. Nothing was run; give the program to "
            "the person, who can run it by `kg robot run FILE`"
        )
    return Elicit(f"Run this program on the robot? It may move.\n\n{program}", _Consent)


class Tools:
    """What is answered about the store in a folder.

    `seconds` is the deadline of each answer; `robot` is the address of the robot, by default that of the environment.
    """

    def __init__(self, store: str, seconds: float, robot: str = "") -> None:
        self._store = ("--store", store)
        self._seconds = seconds
        self._robot = ("--robot", robot) if robot else ()
        self.readers: Readers | None = None
        """The readers, while the server runs."""

    @property
    def reading(self) -> tuple[Callable[..., Coroutine[Any, Any, str]], ...]:
        """The tools that change nothing, in the order that they are listed."""
        return (
            *(self.find_nodes, self.describe_node, self.wiring, self.topic, self.lint, self.impact, self.diff),
            *(self.query, self.why, self.capabilities, self.robot_capabilities, self.robot_read, self.check_program),
        )

    @property
    def acting(self) -> tuple[Callable[..., Coroutine[Any, Any, str]], ...]:
        """The tools that may move a robot."""
        return (self.run_program,)

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
        limit: Annotated[int, Field(ge=1, le=_MOST_HITS)] = 8,
        detail: Detail = False,
        page: Page = 1,
    ) -> str:
        """Find ROS nodes by what they do, what they subscribe and publish, and the hardware they work with.

        Answers ranked nodes, each with the reasons it matches and the line of code or text of each reason. Use it
        before you write a node: one may exist.
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
        return await self._lines(
            "find", {"text": need, "limit": str(limit), **filters}, lines.hits, detail=detail, page=page
        )

    async def describe_node(
        self,
        name: Annotated[str, Field(description="The node's name, `package/node`, or its IRI.")],
        *,
        detail: Detail = False,
        page: Page = 1,
    ) -> str:
        """Describe one ROS node: topics, services, actions, parameters with types and QoS, purpose, hardware, start.

        Each fact has its line of code. Functions, hardware and capabilities are inferred, with a grade (certain,
        strong, weak); `why` proves them. `detail` adds what frameworks create, all texts, and the nodes around it.
        """
        arguments = {"iri": name} if "://" in name else {"name": name}
        return await self._lines("node", arguments, lines.node, detail=detail, page=page)

    async def wiring(self, system: System = "", *, detail: Detail = False, page: Page = 1) -> str:
        """Show what a launch file starts, the topics and services between its nodes, and what is wrong.

        Without `system`, list the launch files of the store.
        """
        if not system:
            return await self._lines("systems", {}, lines.systems, detail=detail, page=page)
        return await self._lines("system", {"name": system}, lines.system, detail=detail, page=page)

    async def topic(
        self,
        name: Annotated[str, Field(description="/cmd_vel, a name in the code (cmd_vel, ~/plan), or a part of a name.")],
        kind: Annotated[
            Literal["topic", "service", "action", "parameter"], Field(description="What it names.")
        ] = "topic",
        system: System = "",
        *,
        detail: Detail = False,
        page: Page = 1,
    ) -> str:
        """Show who uses a topic, service or action, or what sets a parameter, in all launch files and in code.

        Each end has its node, line of code, launch line and QoS, and what does not fit. Several names are listed.
        """
        arguments = {"name": name, "system": system}
        if kind == "parameter":
            return await self._lines("parameter", arguments, lines.parameter, detail=detail, page=page)
        return await self._lines("channel", {"kind": kind, **arguments}, lines.channel, detail=detail, page=page)

    async def lint(
        self,
        system: System = "",
        package: Annotated[str, Field(description="Only launch files of this package.")] = "",
        *,
        detail: Detail = False,
        page: Page = 1,
    ) -> str:
        """Report what is wrong in the wiring of launch files: topic typos, type and QoS clashes, missing publishers.

        Each finding has a code and its place; `detail` adds the remedy and the evidence.
        """
        arguments = {"system": system, "package": package}
        return await self._lines("lint", arguments, lines.findings, none="nothing is wrong", detail=detail, page=page)

    async def impact(
        self,
        name: Annotated[
            str,
            Field(description="A topic, service, action, `package/Type`, `node.parameter`, node, launch file or file."),
        ],
        kind: Annotated[str, Field(description="Its kind, where the name means several things.")] = "",
        *,
        detail: Detail = False,
        page: Page = 1,
    ) -> str:
        """Show what breaks, and what may break, if a name is renamed, removed or changed. Ask before you change it."""
        return await self._lines("impact", {"name": name, "kind": kind}, lines.impact, detail=detail, page=page)

    async def diff(
        self,
        commits: Annotated[str, Field(description="main..HEAD, or main...HEAD from their merge base.")],
        folder: Annotated[str, Field(description="The checkout; by default that of the store's only source.")] = "",
        *,
        page: Page = 1,
    ) -> str:
        """Show what changed between two commits in interfaces of nodes and in the wiring of launch files."""
        if ".." not in commits or commits.startswith("-"):
            raise ToolError("name two commits as main..HEAD")
        if not folder:
            roots = [one["root"] for one in (await self._answer("overview", {}))["sources"]]
            folder = roots[0] if len(roots) == 1 and roots[0] else "."  # else the folder of the server
        advice = f"Commits that were read are kept: call again, or run `kg diff {commits}` in a terminal"
        return await self._command(
            *("diff", commits, "--repository", folder), seconds=_DIFF_SECONDS, page=page, advice=advice
        )

    async def query(
        self,
        sparql: Annotated[str, Field(description="A SPARQL 1.1 query; the prefixes ros:, rnkg:, rdfs: ... are known.")],
        limit: Annotated[int, Field(ge=1, le=_MOST_ROWS)] = 50,
        *,
        page: Page = 1,
    ) -> str:
        """Run a read-only SPARQL query over everything that is known.

        Classes: rnkg:NodeType, rnkg:Package, ros:Topic, ros:Service, ros:Message ... Properties of nodes:
        rnkg:publishes, rnkg:subscribes, rnkg:hasFunction, rnkg:usesHardware, rnkg:hasCapability; places: rnkg:path,
        rnkg:line. For example: SELECT ?node ?topic { ?node rnkg:publishes/rdfs:label ?topic } .
        """
        question = Question(text=sparql, formats=_FORMATS, rows=limit)
        try:
            async with self._open.ask(question, seconds=min(self._seconds, _QUERY_SECONDS)) as answer:
                body = b"".join([part async for part in answer.parts()]).decode()
        except KgError as error:
            if error.code == _TOO_LONG:
                raise ToolError(f"{error}. Narrow the patterns, or start from a name or a LIMIT.") from error
            raise tool_error(error) from error
        if answer.head.kind == "boolean":
            return "yes" if json.loads(body)["boolean"] else "no"
        answer_lines = body.splitlines()
        if answer.head.kind == "rows" and len(answer_lines) < _HEADED:
            problems = (await self._answer("diagnose", {"text": sparql}))["problems"]
            hints = [f"{one['message']}. {one['hint'] or ''}".rstrip() for one in problems]
            return lines.paged([*answer_lines, "no rows", *hints], [], page, PAGE)
        more = [f"there are more rows than {limit}"] if answer.end and answer.end.more else []
        return lines.paged(answer_lines or ["no triples"], more, page, PAGE)

    async def why(
        self,
        subject: Annotated[str, Field(description="A name in the store, a prefixed name, or an IRI.")],
        predicate: Annotated[str, Field(description="A property, e.g. hasFunction, rnkg:usesHardware or an IRI.")],
        value: Annotated[str, Field(description="A name in the store, a prefixed name, a literal, or an IRI.")],
        *,
        detail: Detail = False,
        page: Page = 1,
    ) -> str:
        """Explain why a fact holds: the rules that derive it and the facts they read, down to the line of code.

        Where it does not hold, answers what each rule that could derive it lacks, with the nearest match.
        """
        fact = {"subject": subject, "predicate": predicate, "object": value}
        try:
            answer = await self._answer("why", fact)
        except KgError as error:
            if error.code != _DOES_NOT_HOLD:
                raise tool_error(error) from error
            return await self._lines("why_not", fact, lines.lacking, detail=detail, page=page)
        return _text(answer, lines.proofs, detail=detail, page=page)

    async def capabilities(self, system: System, *, detail: Detail = False, page: Page = 1) -> str:
        """List what the robot of a launch file can sense and do, with the topics, services and actions to use."""
        return await self._lines("capabilities", {"system": system}, lines.capabilities, detail=detail, page=page)

    async def robot_capabilities(self, *, page: Page = 1) -> str:
        """List what the running robot can sense and do now. Programs are written with these names."""
        return await self._command("robot", "capabilities", "--live", *self._robot, seconds=_ROBOT_SECONDS, page=page)

    async def robot_read(
        self, capability: Annotated[str, Field(description="Its name or label, e.g. sensingPose.")]
    ) -> str:
        """Read one value of what the running robot senses."""
        if capability.startswith("-"):
            raise ToolError("name a capability, as `robot_capabilities` lists them")
        return await self._command("robot", "read", capability, "--once", *self._robot, seconds=_ROBOT_SECONDS)

    async def check_program(
        self,
        program: Program,
        system: Annotated[
            str, Field(description="Check it for the robot of this launch file; else the running one.")
        ] = "",
        *,
        page: Page = 1,
    ) -> str:
        """Check a program for a robot without running it: names, units, limits, dead code."""
        robot = ("--launch", system, *self._store) if system else self._robot
        with program_file(program) as (folder, path):
            return await self._command("robot", "check", path, *robot, seconds=_ROBOT_SECONDS, page=page, hidden=folder)

    async def run_program(
        self,
        program: Program,
        consent: Annotated[ElicitationResult[_Consent], Resolve(ask_person)],
        *,
        dry_run: Annotated[bool, Field(description="Show what would be sent, and move nothing.")] = True,
        page: Page = 1,
    ) -> str:
        """Run a program on the running robot. By default it is a dry run, which moves nothing.

        With `dry_run` false a person is asked first, by the assistant's own window; without their consent nothing
        runs. The program is checked, and the robot is stopped however it ends.
        """
        if not dry_run and not (isinstance(consent, AcceptedElicitation) and consent.data.run):
            raise ToolError("the person did not agree; nothing was run")
        how, seconds = ("--dry-run", _ROBOT_SECONDS) if dry_run else ("--exclusive", _RUN_SECONDS)
        with program_file(program) as (folder, path):
            return await self._command(
                *("robot", "run", path, how, *self._robot, *self._store), seconds=seconds, page=page, hidden=folder
            )

    async def nodes(self, page: int = 1) -> str:
        """Return the names of the nodes by package, for the resource of that name."""
        answer = await self._answer("list", {"of": "nodes", "limit": str(_MOST_NODES)})
        return _document("nodes", lines.nodes(answer, lines.Where(), detail=False), page)

    async def launch_files(self, page: int = 1) -> str:
        """Return the launch files with their counts, for the resource of that name."""
        answer = await self._answer("systems", {})
        return _document("launch-files", lines.systems(answer, lines.Where(), detail=False), page)

    async def rules(self, page: int = 1) -> str:
        """Return the names and titles of the rules in force, for the resource of that name."""
        answer = await self._answer("rules", {})
        every = (one for family in answer["families"] if family["in_force"] for one in family["rules"])
        return _document("rules", (f"{one['rule']}: {one['title']}" for one in every), page)

    async def rule(self, name: str, page: int = 1) -> str:
        """Return a page of the text of a rule, for the resource of that name."""
        try:
            answer = await self._answer("rule", {"name": name})
        except KgError as error:
            raise tool_error(error) from error
        return lines.paged(str(answer["text"]).splitlines(), [], page, PAGE, further=_further("rule", name))

    async def node(self, name: str, page: int = 1) -> str:
        """Return a page of `describe_node`, for the resource of that name."""
        return await self._lines("node", {"name": name}, lines.node, page=page, further=_further("node", name))

    async def launch_file(self, name: str, page: int = 1) -> str:
        """Return a page of `wiring`, for the resource of that name."""
        further = _further("launch-file", name)
        return await self._lines("system", {"name": name}, lines.system, page=page, further=further)

    async def _lines(  # noqa: PLR0913 - a view, and how it is shown
        self,
        view: str,
        arguments: dict[str, Any],
        written: Callable[..., Any],
        *,
        none: str = "nothing",
        detail: bool = False,
        page: int,
        further: str = lines.FURTHER,
    ) -> str:
        try:
            answer = await self._answer(view, arguments)
        except KgError as error:
            raise tool_error(error) from error
        return _text(answer, written, none=none, detail=detail, page=page, further=further)

    async def _answer(self, view: str, arguments: dict[str, Any]) -> dict[str, Any]:
        answer: dict[str, Any] = json.loads(await self._open.call(view, arguments, seconds=self._seconds))
        return answer

    async def _command(self, *arguments: str, seconds: float, page: int = 1, hidden: str = "", advice: str = "") -> str:
        try:
            code, text = await run_command(*arguments, seconds=seconds)
        except TimeoutError:
            problem = f"it took longer than {seconds:.0f} seconds and was ended"
            raise ToolError(f"{problem}. {advice}" if advice else problem) from None
        text = text.replace(hidden, "") if hidden else text
        answer = lines.paged(text.splitlines() or ["done"], [], page, PAGE)
        if code and "error[" in text:
            raise ToolError(answer)
        return answer

    @property
    def _open(self) -> Readers:
        if self.readers is None:
            raise ToolError("the server is not running")
        return self.readers


def _text(  # noqa: PLR0913 - how an answer is shown
    answer: dict[str, Any],
    written: Callable[..., Any],
    *,
    none: str = "nothing",
    detail: bool,
    page: int,
    further: str = lines.FURTHER,
) -> str:
    where = lines.Where()
    shown = list(written(answer, where, detail=detail)) or [none]
    return lines.paged(shown, where.legend, page, _DETAILED if detail else PAGE, further=further)


def _further(kind: str, name: str) -> str:
    return f"kg://{kind}/{quote(name)}?page={{}}"


def _document(name: str, shown: Iterable[str], page: int) -> str:
    """Return a page of the resource that lists what a store has; the next page is a resource of its own."""
    return lines.paged(shown, [], page, PAGE, further=f"kg://{name}/{{}}")


def tool_error(error: KgError) -> ToolError:
    """Return an error as the assistant reads it, with the way out."""
    return ToolError(lines.paged([f"{error}. {error.hint}" if error.hint else str(error)], [], 1, PAGE))
