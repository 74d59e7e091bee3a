"""The server: Model Context Protocol on standard input and output, by the official SDK."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import unquote

from mcp.server.mcpserver import MCPServer
from mcp.server.mcpserver.exceptions import ToolError, UnexpectedToolError
from mcp.types import ToolAnnotations
from pydantic import ValidationError

from kg.assistants.tools import Tools, tool_error
from kg.errors import UsageError
from kg.lazily import lazily
from kg.query.readers.pool import Readers
from kg.similar import did_you_mean
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Mapping

    from kg.settings import Settings


with lazily():
    from importlib.metadata import version


_CODE: Final = "KG003"
_MOST: Final = 60  # characters of a wrong value that are shown


def unknown_tool(name: str, tools: Iterable[str]) -> UsageError:
    """Return the error for a tool that does not exist."""
    names = sorted(tools)
    return UsageError(
        "KG001", f"unknown tool `{name}`", hint=did_you_mean(name, names) or f"Tools: {', '.join(names)}."
    )


def names_error(tool: str, schema: Mapping[str, Any], given: Iterable[str]) -> UsageError | None:
    """Return the error for arguments that are missing or that the tool does not have; None if there are none."""
    properties, needed, names = schema.get("properties", {}), schema.get("required", ()), set(given)
    unknown, missing = sorted(names - properties.keys()), [name for name in needed if name not in names]
    if not unknown and not missing:
        return None
    problems = [f"unknown argument `{name}`" for name in unknown]
    problems += [f"missing argument `{name}`" for name in missing]
    advice = [did_you_mean(name, properties) for name in unknown]
    return UsageError(_CODE, f"{tool}: {', '.join(problems)}", hint=_hint(schema, advice))


def values_error(tool: str, schema: Mapping[str, Any], error: ValidationError) -> UsageError:
    """Return the error for values that the tool does not accept."""
    problems = []
    for one in error.errors(include_url=False, include_context=False):
        name, value = ".".join(map(str, one["loc"])), repr(one["input"])
        shown = value if len(value) <= _MOST else f"{value[:_MOST]}..."
        problems.append(f"`{name}` is {shown}: {one['msg'][:1].lower()}{one['msg'][1:]}")
    return UsageError(_CODE, f"{tool}: {'; '.join(problems)}", hint=_hint(schema, ()))


def _hint(schema: Mapping[str, Any], advice: Iterable[str | None]) -> str:
    needed = schema.get("required", ())
    takes = [f"`{name}`: {_kind(one)}{', required' if name in needed else ''}" for name, one in
             schema.get("properties", {}).items()]  # fmt: skip
    return " ".join((*filter(None, advice), f"Arguments: {'; '.join(takes)}."))


def _kind(schema: Mapping[str, Any]) -> str:
    choices = [one for one in schema.get("anyOf", ()) if one.get("type") != "null"]
    if choices:
        return " or ".join(map(_kind, choices))
    if "enum" in schema:
        return " or ".join(map(repr, schema["enum"]))
    kind = str(schema.get("type", "any"))
    if kind == "array":
        return f"list of {_kind(schema.get('items', {}))}s"
    least, most = schema.get("minimum"), schema.get("maximum")
    if least is not None and most is not None:
        return f"{kind} from {least} to {most}"
    return f"{kind} from {least}" if least is not None else kind


_INSTRUCTIONS: Final = """\
kg is an index of the ROS nodes of this workspace: their topics, services, actions and parameters, their purpose, and
their wiring by launch files, each fact with its line of code. Query it before you read many sources or write a node.
Answers have one line per fact, with FILE:LINE; open that line before you rely on an inferred fact. Long answers
have pages. Only `run_program` can move a robot, and only with a person's consent."""

_READERS: Final = 2
_SECONDS: Final = 30.0
"""How long an answer may take, where nothing else is set; queries of an assistant end after 10 s."""


class _Server(MCPServer):
    """The server of the SDK, with errors about arguments in the form of the errors of `kg`."""

    async def call_tool(self, name: str, arguments: dict[str, Any], context: Any = None) -> Any:
        """Return the result of a tool; ToolError where it fails, or does not take these arguments."""
        schemas = {tool.name: tool.input_schema for tool in await self.list_tools()}
        if name not in schemas:
            raise tool_error(unknown_tool(name, schemas))
        if problem := names_error(name, schemas[name], arguments):
            raise tool_error(problem)
        try:
            return await super().call_tool(name, arguments, context)
        except UnexpectedToolError:
            raise
        except ToolError as error:
            if isinstance(error.__cause__, ValidationError):
                raise tool_error(values_error(name, schemas[name], error.__cause__)) from None
            raise ToolError(str(error).removeprefix(f"Error executing tool {name}: ")) from error


def create_server(settings: Settings) -> MCPServer:
    """Return the server of the store of the settings; StoreError KG301 when there is none."""
    layout = layout_of(settings)
    tools = Tools(layout.address or str(layout.root), settings.timeout or _SECONDS, settings.robot)

    @asynccontextmanager
    async def lifespan(_server: MCPServer) -> AsyncIterator[None]:
        async with Readers(
            layout, processes=_READERS, calls="kg.views.calls", prepare="prepare", settings=settings.chosen()
        ) as readers:
            tools.readers = readers
            try:
                yield
            finally:
                tools.readers = None

    server = _Server(
        "kg", version=version("kg-ros"), instructions=_INSTRUCTIONS, lifespan=lifespan, log_level="WARNING"
    )
    for tool in tools.reading:
        annotations = ToolAnnotations(read_only_hint=True, idempotent_hint=True, open_world_hint=False)
        server.add_tool(tool, annotations=annotations, structured_output=False)
    for tool in tools.acting:
        annotations = ToolAnnotations(read_only_hint=False, destructive_hint=True, open_world_hint=True)
        server.add_tool(tool, annotations=annotations, structured_output=False)
    _add_resources(server, tools)
    _add_prompts(server)
    return server


def _add_resources(server: MCPServer, tools: Tools) -> None:
    """Offer what the store has as documents: lists, and one document for each node, launch file and rule."""
    _add_list(server, "nodes", "The nodes of the store, by package", tools.nodes)
    _add_list(server, "launch-files", "The launch files of the store", tools.launch_files)
    _add_list(server, "rules", "The rules in force, by name and title", tools.rules)

    @server.resource("kg://node/{package}/{name}{?page}", description="One node.", mime_type="text/plain")
    async def node(package: str, name: str, page: int = 1) -> str:
        return await tools.node(f"{unquote(package)}/{unquote(name)}", page)

    @server.resource(
        "kg://launch-file/{+name}{?page}", description="What a launch file starts.", mime_type="text/plain"
    )
    async def launch_file(name: str, page: int = 1) -> str:
        return await tools.launch_file(unquote(name), page)

    @server.resource("kg://rule/{family}/{name}{?page}", description="One rule: its text.", mime_type="text/plain")
    async def rule(family: str, name: str, page: int = 1) -> str:
        return await tools.rule(f"{unquote(family)}/{unquote(name)}", page)


def _add_list(server: MCPServer, name: str, description: str, listed: Callable[[int], Awaitable[str]]) -> None:
    @server.resource(f"kg://{name}", description=f"{description}.", mime_type="text/plain")
    async def first() -> str:
        return await listed(1)

    @server.resource(f"kg://{name}/{{page}}", description=f"{description}, a page.", mime_type="text/plain")
    async def further(page: int) -> str:
        return await listed(page)


def _add_prompts(server: MCPServer) -> None:
    """Offer the tasks that people bring, each with the tools that lead through it."""

    @server.prompt(description="Find a node for a need before writing one.")
    def find_node(need: str) -> str:
        return (
            f"Find an existing ROS node for this need: {need}\n"
            "Call find_nodes with the need, and with types if it names any. Describe the best two with describe_node. "
            "Say which one fits, what it publishes and subscribes with FILE:LINE, how to start it, and what is "
            "missing. Say so if none fits."
        )

    @server.prompt(description="Review a change of launch files or interfaces.")
    def review_launch_change(commits: str) -> str:
        return (
            f"Review the change {commits}. Call diff with these commits, then impact for each name that changed, then "
            "lint for each launch file concerned. Report what breaks, each with FILE:LINE, and what to correct."
        )

    @server.prompt(description="Write a rule that infers new facts.")
    def write_rule(conclusion: str) -> str:
        return (
            f"Write a rule of kg that infers: {conclusion}\n"
            "Read the resource kg://rules for rules of the same kind, and one of them as kg://rule/FAMILY/NAME. Try "
            "the pattern with query first. Write rules/FAMILY/NAME.rq with the sections of the others as comments, "
            "and NAME.md with an example that holds and one that does not. Ask the person to run `kg rules test`."
        )

    @server.prompt(description="Write a program for the robot.")
    def write_program(task: str) -> str:
        return (
            f"Write a program for the robot that does: {task}\n"
            "Call robot_capabilities (or capabilities with a launch file). A program is lines such as "
            "`goingToPose x: 3 m, y: 1 m within 60 s`, `while nearest of laserScanning > 1 m ... end`, "
            "`as soon as CONDITION do ... during ... end`. Call check_program, follow its hints until it reports no "
            "error, then run_program as a dry run. Show the program to the person before anything moves."
        )


def serve(settings: Settings) -> None:
    """Serve until standard input ends.

    Raises:
        StoreError: KG301 there is no store.
        BrokenPipeError: the client ended while a call ran.
    """
    try:
        create_server(settings).run("stdio")
    except ExceptionGroup as group:
        if group.split(BrokenPipeError)[1]:
            raise
        raise BrokenPipeError from group
