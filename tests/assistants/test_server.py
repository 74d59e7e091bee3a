"""The server as an assistant uses it, by the client of the official SDK."""

from __future__ import annotations

import asyncio
import json
import sys
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractAsyncContextManager
    from pathlib import Path

    Connected = Callable[[], AbstractAsyncContextManager[Any]]


def asked(connected: Connected, tool: str, **arguments: Any) -> tuple[bool, Any]:
    """Return whether a call of a tool failed, and what it answers: an object, or the text of the error."""

    async def run() -> tuple[bool, Any]:
        async with connected() as client:
            result = await client.call_tool(tool, arguments)
            text = result.content[0].text
            return bool(result.is_error), text if result.is_error else json.loads(text)

    return asyncio.run(run())


def test_the_tools_are_listed_as_reading_only(connected: Connected) -> None:
    """There are seven tools, each with a description, and each says that it changes nothing."""

    async def run() -> list[Any]:
        async with connected() as client:
            return list((await client.list_tools()).tools)

    tools = asyncio.run(run())
    assert [tool.name for tool in tools] == [
        *("find_nodes", "describe_node", "wiring", "ends_of", "lint", "query", "explain")
    ]
    assert all(tool.description and tool.annotations.read_only_hint for tool in tools)


def test_nodes_are_found_with_reasons(connected: Connected) -> None:
    """A need in plain words and a filter find a node of the workspace, with reasons and a line of its code."""
    failed, found = asked(connected, "find_nodes", need="filter laser scans", subscribes=["LaserScan"])
    assert not failed
    first = found["hits"][0]
    assert first["node"] == "scan_filter"
    assert first["reasons"]
    assert ".cpp:" in json.dumps(first) or ".py:" in json.dumps(first)


def test_a_node_is_described_with_lines(connected: Connected) -> None:
    """Each interface of a node comes with the file and line that state it."""
    failed, node = asked(connected, "describe_node", name="scan_filter")
    assert not failed
    assert node["interfaces"]
    assert all(":" in row["evidence"] for row in node["interfaces"])


def test_an_unknown_node_is_told_with_the_one_meant(connected: Connected) -> None:
    """The error for a name that is misspelt has the code and the likely name."""
    failed, message = asked(connected, "describe_node", name="scan_fliter")
    assert failed
    assert "KG001" in message
    assert "scan_filter" in message


def test_launch_files_are_listed_and_wired(connected: Connected) -> None:
    """Without a name the launch files are listed; with one of these names its nodes and topics are told."""
    failed, listed = asked(connected, "wiring")
    assert not failed
    name = next(one["name"] for one in listed["systems"] if one["name"].endswith("rover.launch"))
    failed, system = asked(connected, "wiring", system=name)
    assert not failed
    assert "/scan" in json.dumps(system)
    assert "picture" not in system


def test_findings_have_codes(connected: Connected) -> None:
    """Findings in the wiring come with their code and evidence."""
    failed, found = asked(connected, "lint")
    assert not failed
    assert found["findings"]
    assert all(one["code"].startswith("KG4") for one in found["findings"])


def test_queries_are_read_only_and_bounded(connected: Connected) -> None:
    """A query answers at most as many rows as asked for and says that there are more; an update is refused."""
    failed, found = asked(connected, "query", sparql="SELECT ?node { ?node a rnkg:NodeType }", limit=2)
    assert not failed
    assert len(found["rows"]) == 2
    assert found["more"]
    failed, message = asked(connected, "query", sparql="DELETE WHERE { ?s ?p ?o }")
    assert failed
    assert "KG501" in message


def test_facts_are_explained(connected: Connected) -> None:
    """What a rule inferred is explained by the rule and a line of code."""
    rows = asked(
        connected,
        "query",
        sparql="SELECT ?node ?function { ?node rnkg:hasFunction ?function } ORDER BY ?node ?function",
        limit=1,
    )[1]["rows"]
    failed, why = asked(
        connected, "explain", subject=rows[0]["node"], predicate="rnkg:hasFunction", value=rows[0]["function"]
    )
    assert not failed
    assert "function/" in json.dumps(why)


def test_what_does_not_hold_is_told_with_what_is_lacking(connected: Connected) -> None:
    """For a fact that does not hold the rules that could derive it are told, each with the pattern that fails."""
    failed, found = asked(
        connected, "explain", subject="scan_filter", predicate="hasFunction", value="function:control"
    )
    assert not failed
    assert found["holds"] is False
    assert "function/" in json.dumps(found)


def test_the_command_speaks_on_standard_streams(store: Path) -> None:
    """`kg mcp` answers a client that starts it, and prints nothing else on standard output."""
    mcp = pytest.importorskip("mcp", reason="the extra `mcp` is not installed")

    async def run() -> Any:
        program = mcp.StdioServerParameters(command=sys.executable, args=["-m", "kg", "--store", str(store), "mcp"])
        async with mcp.Client(program) as client:
            return await client.call_tool("query", {"sparql": "ASK { ?node a rnkg:NodeType }"})

    assert json.loads(asyncio.run(run()).content[0].text)["answer"] is True


def test_ends_of_a_name_in_a_system(connected: Connected) -> None:
    """A name after remapping has its node, the launch line and the line of code; a parameter its values."""
    failed, found = asked(connected, "ends_of", name="/rover1/mux/cmd_vel")
    assert not failed
    assert found["endpoints"][0]["instance"] == "/rover1/base_controller"
    assert ":7" in found["endpoints"][0]["launched"]
    failed, found = asked(connected, "ends_of", name="/trace_logger/rate", kind="parameter")
    assert (failed, found["values"][0]["value"]) == (False, "5")
