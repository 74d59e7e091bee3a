"""The server: Model Context Protocol on standard input and output, by the official SDK."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Final

from mcp.server.mcpserver import MCPServer
from mcp.types import ToolAnnotations

from kg.assistants.tools import Tools
from kg.query.readers.pool import Readers
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.settings import Settings

__all__ = ["create_server", "serve"]

_INSTRUCTIONS: Final = """\
kg knows the ROS nodes of this workspace: what they publish, subscribe, offer and need, what they are for, how launch
files wire them, and on which line of code each of these stands. Ask it before you read sources at length or write a
node. Nothing is changed by asking. Evidence is FILE:LINE; open it before you rely on what was inferred."""

_READERS: Final = 2


def create_server(settings: Settings) -> MCPServer:
    """Return the server of the store of the settings; StoreError KG301 when there is none."""
    from importlib.metadata import version  # noqa: PLC0415 - searches the installation

    layout = layout_of(settings)
    tools = Tools(settings.timeout or None)

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

    server = MCPServer(
        "kg", version=version("kg-ros"), instructions=_INSTRUCTIONS, lifespan=lifespan, log_level="WARNING"
    )
    for tool in tools.all:
        annotations = ToolAnnotations(read_only_hint=True, idempotent_hint=True, open_world_hint=False)
        server.add_tool(tool, annotations=annotations)
    return server


def serve(settings: Settings) -> None:
    """Serve until standard input ends; StoreError KG301 when there is no store."""
    create_server(settings).run("stdio")
