"""The server as used by an assistant, with the client of the official SDK."""

from __future__ import annotations

import asyncio
import json
import re
import subprocess
import sys
from typing import TYPE_CHECKING, Any, Final

import pytest

from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractAsyncContextManager
    from pathlib import Path

    Connected = Callable[..., AbstractAsyncContextManager[Any]]

MOST: Final = 3072
"""Bytes of a response including the protocol overhead."""
ROVER: Final = "rover_robot/launch/rover.launch"


def asked(connected: Connected, tool: str, **arguments: Any) -> tuple[bool, str]:
    """Return whether a tool call failed, and its response, which is short and sent once."""
    return answered(connected(), tool, arguments)


def answered(client: AbstractAsyncContextManager[Any], tool: str, arguments: dict[str, Any]) -> tuple[bool, str]:
    """Return the response to a client, like `asked`."""

    async def run() -> tuple[bool, str]:
        async with client as session:
            result = await session.call_tool(tool, arguments)
        assert result.structured_content is None
        assert len(result.content) == 1
        if not arguments.get("detail"):
            assert len(result.model_dump_json().encode()) <= MOST
        return bool(result.is_error), result.content[0].text

    return asyncio.run(run())


TASKS: Final[dict[str, list[tuple[str, dict[str, Any], str]]]] = {
    "find a node to filter scans, and how to start it": [
        ("find_nodes", {"need": "filter laser scans"}, "rover_robot/scan_filter"),
        ("describe_node", {"name": "rover_robot/scan_filter"}, "start: rosrun nodelet nodelet standalone"),
    ],
    "say what a node publishes, with lines": [
        ("describe_node", {"name": "scan_filter"}, "publishes  scan_filtered  sensor_msgs/LaserScan"),
    ],
    "list launch files and look into one": [
        ("wiring", {}, ROVER),
        ("wiring", {"system": ROVER}, "starts  /rover1/patrol  rover_robot/patrol"),
    ],
    "find who publishes a topic": [
        ("topic", {"name": "/rover1/scan_filtered"}, "publishes  /rover1/scan_filter  rover_robot/scan_filter"),
    ],
    "find where a parameter is set": [
        ("topic", {"name": "/trace_logger/rate", "kind": "parameter"}, "= 5"),
    ],
    "find what is wrong and how to mend it": [
        ("lint", {}, "KG401"),
        ("lint", {"detail": True}, "remedy: Remap one of the two names"),
    ],
    "say what breaks before a rename": [
        ("impact", {"name": "/rover1/scan_filtered"}, "breaks  /rover1/patrol subscribes to it"),
    ],
    "explain a class, and why another does not hold": [
        ("why", {"subject": "scan_filter", "predicate": "hasFunction", "value": "dataProcessing"}, "function/weighed"),
        ("why", {"subject": "scan_filter", "predicate": "hasFunction", "value": "control"}, "does not hold"),
    ],
    "query the graph": [
        ("query", {"sparql": "ASK { ?node a rnkg:NodeType }"}, "yes"),
        ("query", {"sparql": "SELECT ?name { ?node a rnkg:NodeType ; rnkg:name ?name } ORDER BY ?name"}, "arm_server"),
    ],
    "write a program for a robot of a launch file": [
        ("capabilities", {"system": ROVER}, "write  drivingAtVelocity"),
        ("check_program", {"program": "drivingAtVelocity forward: 0.2 m/s for 1 s", "system": ROVER}, ""),
    ],
}
"""Tasks of assistants: the calls of each, and a part of each response."""


@pytest.mark.parametrize("task", TASKS)
def test_a_task_is_done_in_short_answers(connected: Connected, task: str) -> None:
    """Each call returns the input of the next one, in at most 3 KB."""
    for tool, arguments, part in TASKS[task]:
        failed, text = asked(connected, tool, **arguments)
        assert not failed, text
        assert part in text


@pytest.mark.parametrize("detail", [False, True])
def test_long_answers_have_pages(connected: Connected, detail: bool) -> None:  # noqa: FBT001 - a case
    """The last page is marked, and no line is on two pages."""
    lines: list[str] = []
    page = pages = 1
    while page <= pages:
        _, text = asked(connected, "wiring", system=ROVER, page=page, detail=detail)
        last = next((line for line in text.splitlines() if line.startswith(f"page {page} of ")), "page 1 of 1")
        pages = int(last.partition(";")[0].split()[-1])
        lines += [line for line in text.splitlines() if not line.startswith(("page ", "paths are"))]
        page += 1
    assert len(lines) == len(set(lines))
    assert any("/rover1/scan_filtered" in line for line in lines)
    assert pages > 1 or detail


def test_only_one_tool_can_move_a_robot(connected: Connected) -> None:
    """All other tools are marked as read-only; each has a description."""

    async def run() -> list[Any]:
        async with connected() as client:
            return list((await client.list_tools()).tools)

    tools = asyncio.run(run())
    assert all(tool.description for tool in tools)
    assert [tool.name for tool in tools if not tool.annotations.read_only_hint] == ["run_program"]


def test_an_unknown_node_is_told_with_the_one_meant(connected: Connected) -> None:
    """The error for a misspelt name has the code and the likely name."""
    failed, message = asked(connected, "describe_node", name="scan_fliter")
    assert failed
    assert "KG001" in message
    assert "scan_filter" in message


@pytest.mark.parametrize(
    ("tool", "arguments", "expected"),
    [
        ("describe_node", {}, "KG003: describe_node: missing argument `name`. Arguments: `name`: string, required; "),
        ("find_nodes", {"need": "scan", "hardwar": ["camera"]}, "unknown argument `hardwar`. Did you mean `hardware`"),
        ("find_nodes", {"publishes": "/scan"}, "`publishes` is '/scan': input should be a valid list. Arguments: "),
        ("find_nodes", {"limit": 1000}, "`limit`: integer from 1 to 50"),
        ("topic", {"name": "/scan", "kind": "topics"}, "`kind`: 'topic' or 'service'"),
        ("describe_nod", {"name": "scan_filter"}, "KG001: unknown tool `describe_nod`. Did you mean `describe_node`"),
    ],
)
def test_wrong_arguments_are_answered_with_those_of_the_tool(
    connected: Connected, tool: str, arguments: dict[str, Any], expected: str
) -> None:
    """A missing, misspelt or wrong argument is an error with a code and the arguments of the tool."""
    failed, message = asked(connected, tool, **arguments)
    assert failed
    assert expected in message
    assert message.startswith("KG00")
    assert "pydantic" not in message


def test_queries_are_read_only_and_bounded(connected: Connected) -> None:
    """A query returns at most the requested rows, with a note about further ones; an update is rejected."""
    failed, text = asked(connected, "query", sparql="SELECT ?node { ?node a rnkg:NodeType }", limit=2)
    assert not failed
    assert text.splitlines()[-1] == "there are more rows than 2"
    assert len(text.splitlines()) == 4
    failed, message = asked(connected, "query", sparql="DELETE WHERE { ?s ?p ?o }")
    assert failed
    assert "KG501" in message


def test_an_empty_result_names_terms_missing_from_the_store(connected: Connected) -> None:
    """A misspelt class gives no rows, and the likely name."""
    failed, text = asked(connected, "query", sparql="SELECT ?node { ?node a rnkg:NodeTyp }")
    assert not failed
    assert "no rows" in text
    assert "`rnkg:NodeTyp` is not in the store. Did you mean `rnkg:NodeType`" in text


def test_a_slow_query_is_told_to_ask_for_less(connected: Connected, monkeypatch: pytest.MonkeyPatch) -> None:
    """The advice is about the query, since a tool has no setting for the time limit."""
    monkeypatch.setattr("kg.assistants.tools._QUERY_SECONDS", 0.2)
    failed, text = asked(connected, "query", sparql="SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }")
    assert failed
    assert "KG503" in text
    assert "Narrow the patterns" in text
    assert "timeout" not in text


def test_changes_are_looked_up_in_the_source_of_the_store(connected: Connected, store: Path) -> None:
    """Wherever the server runs, the checkout is that of the store's only source, here a folder without git."""
    failed, text = asked(connected, "diff", commits="HEAD~1..HEAD")
    assert failed
    assert "not a git repository" in text
    assert f"--> {store.parent}" in text


def test_a_slow_comparison_says_how_to_go_on(connected: Connected, monkeypatch: pytest.MonkeyPatch) -> None:
    """A comparison that takes too long is ended, and the error advises what to do."""
    monkeypatch.setattr("kg.assistants.tools._DIFF_SECONDS", 0.01)
    failed, message = asked(connected, "diff", commits="main..HEAD")
    assert failed
    assert "call again, or run `kg diff main..HEAD` in a terminal" in message


def test_a_program_is_checked_with_hints(connected: Connected) -> None:
    """The error has the line and the suggested capability, and no path of this machine."""
    failed, message = asked(connected, "check_program", program="goingToPse x: 1 m", system=ROVER)
    assert failed
    assert "program.kgp:1:1" in message
    assert "KG832" in message
    assert "--> program.kgp" in message


PROGRAM: Final = 'log "it runs"'


def test_nothing_runs_where_nobody_can_be_asked(connected: Connected) -> None:
    """A client without elicitation is rejected before any search for a robot."""
    failed, message = asked(connected, "run_program", program=PROGRAM, dry_run=False)
    assert failed
    assert "elicitation" in message


@pytest.mark.parametrize(
    ("action", "content", "part"),
    [
        ("accept", {"run": True}, "it runs"),
        ("accept", {"run": False}, "did not agree"),
        ("decline", None, "did not agree"),
        ("cancel", None, "did not agree"),
    ],
)
def test_a_program_runs_only_if_a_person_agrees(
    connected: Connected, action: str, content: dict[str, Any] | None, part: str
) -> None:
    """The user is shown the program; without consent it does not run on the simulated robot."""
    pytest.importorskip("pybullet", reason="worlds need pybullet")
    pytest.importorskip("cv2", reason="tags need OpenCV")
    from mcp.types import ElicitResult  # noqa: PLC0415 - needs the SDK

    from kg.robot.simulation.running import Choice, simulate  # noqa: PLC0415 - needs pybullet

    shown: list[str] = []

    async def person(_context: Any, asked_: Any) -> Any:
        shown.append(asked_.message)
        return ElicitResult.model_validate({"action": action, "content": content})

    async def run() -> str:
        begun: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        simulating = asyncio.create_task(simulate(Choice("office"), begun.set_result))
        try:
            settings = {"robot": await begun}
            async with connected(settings, elicitation_callback=person) as client:
                result = await client.call_tool("run_program", {"program": PROGRAM, "dry_run": False})
                return str(result.content[0].text)
        finally:
            simulating.cancel()
            await asyncio.gather(simulating, return_exceptions=True)

    assert part in asyncio.run(run())
    assert len(shown) == 1
    assert PROGRAM in shown[0]


def test_resources_and_prompts_lead_to_the_tools(connected: Connected) -> None:
    """Lists, a node, a launch file and a rule are documents; prompts name the tools of their task."""

    async def run() -> dict[str, str]:
        async with connected() as client:
            found = {}
            for uri in (
                *("kg://nodes", "kg://launch-files", "kg://rules", "kg://node/rover_robot/scan_filter"),
                *(f"kg://launch-file/{ROVER}", f"kg://launch-file/{ROVER.replace('/', '%2F')}"),
                "kg://rule/function/weighed",
            ):
                found[uri] = (await client.read_resource(uri)).contents[0].text
            for prompt in (await client.list_prompts()).prompts:
                arguments = {one.name: "x" for one in prompt.arguments}
                found[prompt.name] = (await client.get_prompt(prompt.name, arguments)).messages[0].content.text
            return found

    found = asyncio.run(run())
    assert re.search(r"^rover_robot: .*\bscan_filter\b", found["kg://nodes"], re.MULTILINE)
    assert ROVER in found["kg://launch-files"]
    assert "architecture/" in found["kg://rules"]
    assert "publishes  scan_filtered" in found["kg://node/rover_robot/scan_filter"]
    assert "starts  /rover1/patrol" in found[f"kg://launch-file/{ROVER}"]
    assert found[f"kg://launch-file/{ROVER}"] == found[f"kg://launch-file/{ROVER.replace('/', '%2F')}"]
    assert "CONSTRUCT" in found["kg://rule/function/weighed"]
    tools = {"find_node": "find_nodes", "review_launch_change": "impact", "write_rule": "query"}
    tools["write_program"] = "check_program"
    assert all(tool in found[prompt] for prompt, tool in tools.items())


def test_lists_are_read_page_by_page(connected: Connected) -> None:
    """Every page of a list is at most 3 KB and names the next one, until the last."""

    async def run() -> list[str]:
        async with connected() as client:
            pages = [(await client.read_resource("kg://rules")).contents[0].text]
            while found := re.search(r"continue with (kg://rules/\d+)", pages[-1]):
                pages.append((await client.read_resource(found[1])).contents[0].text)
            return pages

    pages = asyncio.run(run())
    assert max(len(page.encode()) for page in pages) <= 3000
    names = [line.partition(":")[0] for page in pages for line in page.splitlines() if "/" in line.partition(":")[0]]
    assert len(pages) > 1
    assert len(names) == len(set(names)) > 50


def test_a_long_rule_has_pages(connected: Connected) -> None:
    """The pages of a resource are at most 3 KB, name the next one by its address, and make up the whole text."""

    async def run() -> list[str]:
        async with connected() as client:
            pages = [(await client.read_resource("kg://rule/architecture/undeclared-argument")).contents[0].text]
            while found := re.search(r"continue with (kg://\S+)", pages[-1]):
                pages.append((await client.read_resource(found[1])).contents[0].text)
            return pages

    pages = asyncio.run(run())
    assert len(pages) > 1
    assert max(len(page.encode()) for page in pages) <= 3000
    text = "\n".join(page.rpartition("\npage ")[0] for page in pages)
    file = folder("rules") / "architecture" / "undeclared-argument.srl"
    assert text.splitlines() == file.read_text("utf-8").splitlines()


def test_the_command_speaks_on_standard_streams(store: Path) -> None:
    """`kg mcp` responds to a client that starts it, and prints nothing else on standard output."""
    mcp = pytest.importorskip("mcp", reason="the extra `mcp` is not installed")
    program = mcp.StdioServerParameters(command=sys.executable, args=["-m", "kg", "--store", str(store), "mcp"])
    failed, text = answered(mcp.Client(program), "query", {"sparql": "ASK { ?node a rnkg:NodeType }"})
    assert (failed, text) == (False, "yes")


def test_a_client_that_ends_during_a_call_is_no_defect(store: Path) -> None:
    """`kg mcp` ends quietly when nobody reads the response."""
    pytest.importorskip("mcp", reason="the extra `mcp` is not installed")
    start = {"protocolVersion": "2025-03-26", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}}
    query = {"name": "query", "arguments": {"sparql": "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f }"}}
    command = [sys.executable, "-m", "kg", "--store", str(store), "mcp"]
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    with subprocess.Popen(command, **pipes, text=True) as program:  # type: ignore[call-overload]  # pipes
        assert program.stdin
        assert program.stdout
        assert program.stderr
        for number, (method, parameters) in enumerate((("initialize", start), ("tools/call", query)), 1):
            message = {"jsonrpc": "2.0", "id": number, "method": method, "params": parameters}
            print(json.dumps(message), file=program.stdin, flush=True)
            if method == "initialize":
                program.stdout.readline()
        program.stdout.close()
        program.stdin.close()
        assert "KG900" not in program.stderr.read()
