"""Service clients and servers of ROS 1: headers, request and response over one connection (wiki.ros.org/ROS/TCPROS)."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from kg.errors import RobotError
from kg.robot.connection import FAILURES, Value, reason
from kg.robot.ros1.header import framed, pack, read_header, read_message
from kg.robot.ros1.names import is_type, peer, shown

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping

    from kg.robot.ros1.node import Node


async def probe(caller: str, uri: str, service: str, *, seconds: float = 2.0) -> str:
    """Request the type of a service from its node at `rosrpc://HOST:PORT`.

    Raises:
        RobotError: KG803 no answer, KG810 an invalid header or type, KG812 an invalid address.
    """
    try:
        async with asyncio.timeout(seconds):
            reader, writer = await asyncio.open_connection(*peer(uri, "rosrpc"))
            try:
                writer.write(pack({"callerid": caller, "service": service, "md5sum": "*", "probe": "1"}))
                header = await read_header(reader, seconds)
            finally:
                writer.close()
    except TimeoutError:
        raise RobotError("KG803", f"{uri} did not report the type of `{service}` within {seconds:g} s") from None
    except OSError as error:
        raise RobotError("KG803", f"{uri} cannot be reached: {error.strerror or error}") from None
    if not is_type(header.get("type")):
        raise RobotError(
            "KG810", f"{uri} reports {shown(header.get('type') or header.get('error'))} as the type of `{service}`"
        )
    return header["type"]


async def call_service(node: Node, uri: str, service: str, kind: str, request: Value) -> Value:
    """Call a service at `rosrpc://HOST:PORT` and return the response; the caller limits the time.

    Raises:
        RobotError: KG803 the node is unreachable or disconnects, KG806 another checksum, KG808 a failure.
    """
    types, caller = node.types, node.name
    content = framed(types.encode(f"{kind}_Request", request))
    try:
        reader, writer = await asyncio.open_connection(*peer(uri, "rosrpc"))
    except OSError as error:
        raise RobotError("KG803", f"`{service}` at {uri} cannot be reached: {error.strerror or error}") from None
    try:
        writer.write(pack({"callerid": caller, "service": service, "md5sum": types.md5(kind), "type": kind}))
        header = await read_header(reader)
        if "error" in header:
            raise RobotError("KG806", f"`{service}` refuses: {shown(header['error'])}")
        writer.write(content)
        succeeded = await reader.read(1)
        answer = await read_message(reader) if succeeded else None
    except OSError as error:
        raise RobotError("KG803", f"`{service}` broke off: {error.strerror or error}") from None
    finally:
        writer.close()
    if answer is None:
        raise RobotError("KG803", f"`{service}` ended the connection without a response")
    if succeeded != b"\x01":
        raise RobotError("KG808", f"`{service}` failed: {answer[:400].decode(errors='replace')}")
    return types.decode(f"{kind}_Response", answer)


class Service:
    """A service of our node."""

    def __init__(self, node: Node, name: str, kind: str, answer: Callable[[Value], Awaitable[Value]]) -> None:
        self.name = name
        self.kind = kind
        self._node = node
        self._answer = answer
        self._open: set[asyncio.StreamWriter] = set()

    async def serve(
        self, header: Mapping[str, str], reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        """Serve a client after its header: one call, or more over a persistent connection."""
        types, sent_sum = self._node.types, header.get("md5sum", "*")
        if sent_sum not in {"*", types.md5(self.kind)}:
            words = f"`{self.name}` is {self.kind} with the sum {types.md5(self.kind)}, not {shown(sent_sum)}"
            self._node.note("KG806", header.get("callerid", "?"), words)
            writer.write(pack({"error": words}))
            return
        ours = {"callerid": self._node.name, "md5sum": types.md5(self.kind), "type": self.kind}
        parts = {"request_type": f"{self.kind}Request", "response_type": f"{self.kind}Response"}
        writer.write(pack({**ours, **parts}))
        if header.get("probe") == "1":
            return
        self._open.add(writer)
        try:
            while (request := await read_message(reader)) is not None:
                writer.write(await self._response(request))
                await writer.drain()
                if header.get("persistent") != "1":
                    return
        finally:
            self._open.discard(writer)

    async def _response(self, request: bytes) -> bytes:
        types = self._node.types
        try:
            value = await self._answer(types.decode(f"{self.kind}_Request", request))
            return b"\x01" + framed(types.encode(f"{self.kind}_Response", value))
        except FAILURES as error:
            return b"\x00" + framed(reason(error).encode())

    def close(self) -> None:
        """Close all connections."""
        for writer in self._open:
            writer.close()
