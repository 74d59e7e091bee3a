"""Tests of the limit on pending requests of one address."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest

from kg.server.safety.floods import Floods

if TYPE_CHECKING:
    from starlette.types import Message, Receive, Scope, Send


@pytest.mark.parametrize(
    ("address", "path", "refused"),
    [
        ("192.0.2.1", "/sparql", True),
        ("192.0.2.1", "/health", False),
        ("192.0.2.1", "/metrics", False),
        ("192.0.2.2", "/sparql", False),
        ("127.0.0.1", "/sparql", False),
    ],
)
def test_one_address_has_a_bound(address: str, path: str, *, refused: bool) -> None:
    """C26: at the limit of pending requests of an address, its next one gets 429, except for health checks."""
    free = asyncio.Event()
    begun: list[str] = []

    async def app(scope: Scope, _receive: Receive, _send: Send) -> None:
        begun.append(scope["path"])
        if scope["path"] == "/held":
            await free.wait()

    async def asked(client: str, wanted: str) -> list[Any]:
        sent: list[Message] = []

        async def send(message: Message) -> None:
            sent.append(message)

        scope = {"type": "http", "method": "GET", "path": wanted, "client": (client, 1), "headers": []}
        await floods(scope, _nothing, send)
        return [message["status"] for message in sent if "status" in message]

    async def run() -> None:
        held = [asyncio.create_task(asked(client, "/held")) for client in ("192.0.2.1", "127.0.0.1")]
        await asyncio.sleep(0)
        assert await asked(address, path) == ([429] if refused else [])
        assert (path in begun) != refused
        free.set()
        await asyncio.gather(*held)
        assert await asked(address, path) == []

    floods = Floods(app, 1)
    asyncio.run(run())


async def _nothing() -> Message:
    return {"type": "http.request"}
