"""The codes of the server for coding assistants: KG555 to KG559."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG555": CodeEntry(
        "MCP SDK missing",
        "`kg mcp` needs the official SDK of the Model Context Protocol, which is an optional part of `kg`.",
        "Install it with `pip install 'kg-ros[mcp]'`.",
    ),
}
