"""XML-RPC client and server over HTTP on asyncio, with limits on bytes and time of everything received.

No entities are expanded (xmlrpc.com/spec.md).
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import Any, Final
from xml.parsers import expat
from xmlrpc import client

from kg.errors import RobotError
from kg.robot.ros1.names import netloc, peer
from kg.robot.tasks import Tasks

_ODD: Final = (expat.ExpatError, client.Error, ValueError, TypeError, LookupError, AttributeError, OverflowError)


def _xml(values: tuple[Any, ...] | client.Fault, method: str | None = None) -> bytes:
    """Return the bytes of a call, or of a response; RobotError KG805 for a value that XML-RPC cannot encode."""
    try:
        return client.dumps(values, method, methodresponse=method is None).encode()
    except (TypeError, OverflowError, UnicodeEncodeError) as error:
        raise RobotError("KG805", f"XML-RPC cannot carry a value: {error}") from None


def xml_read(content: bytes) -> tuple[str | None, list[Any]]:
    """Return method and values in a call or response; for a response the method is None.

    Raises:
        RobotError: KG810 invalid bytes, or a document type, which can expand without limit; KG813 a fault.
    """
    target = client.Unmarshaller(use_builtin_types=True)
    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = _refuse
    parser.StartElementHandler = target.start
    parser.EndElementHandler = target.end
    parser.CharacterDataHandler = target.data
    target.xml(None, None)  # type: ignore[arg-type]  # no encoding: expat gives texts, as in xmlrpc.client.ExpatParser
    try:
        parser.Parse(content, True)
        values = list(target.close())
    except client.Fault as error:
        raise RobotError("KG813", f"a peer refused a call: {error.faultString!s:.200}") from None
    except _ODD as error:
        raise RobotError("KG810", f"{len(content)} bytes are not XML-RPC: {error!s:.200}") from None
    return target.getmethodname(), values


def _refuse(*_: object) -> None:
    raise ValueError("it declares a document type")


MOST_BYTES: Final = 1 << 24
"""Maximum size of a body: ten times the state of a system with ten thousand topics."""

_MOST_REQUEST: Final = 1 << 20
_MOST_CONNECTIONS: Final = 256
_IDLE: Final = 30.0
_SLOWEST: Final = 5.0
_BACKLOG: Final = 1024
_ENDING: Final = 1.0  # seconds for pending responses when the server stops


async def ask(uri: str, method: str, *arguments: Any, seconds: float = 3.0) -> Any:
    """Call a method of the Master, Slave or Parameter API and return its value (wiki.ros.org/ROS/Master_API).

    Raises:
        RobotError: those of `call`, and KG813 if the peer reports a failure.
    """
    return value(uri, method, await exchange(uri, method, *arguments, seconds=seconds))


def value(uri: str, method: str, content: bytes) -> Any:
    """Return the value in the bytes of an answer to `ask`; errors as there."""
    reply = _only(uri, method, content)
    if not isinstance(reply, list) or len(reply) != 3 or type(reply[0]) is not int:  # noqa: PLR2004 - code, words, value
        raise RobotError("KG810", f"{uri} answers `{method}` with no list of code, words and value")
    if reply[0] != 1:
        raise RobotError("KG813", f"{uri} refuses `{method}`: {reply[1]!s:.200}")
    return reply[2]


async def call(uri: str, method: str, *arguments: Any, seconds: float = 3.0) -> Any:
    """Call a method of a peer and return its result.

    Raises:
        RobotError: those of `exchange`, KG810 the answer is not XML-RPC, KG813 it is a fault.
    """
    return _only(uri, method, await exchange(uri, method, *arguments, seconds=seconds))


async def exchange(uri: str, method: str, *arguments: Any, seconds: float = 3.0) -> bytes:
    """Call a method of a peer and return the bytes of its answer.

    Raises:
        RobotError: KG803 the peer is unreachable or does not answer in time, KG810 its answer is not HTTP, KG812 an
            invalid address.
    """
    host, port = peer(uri)
    body = _xml(arguments, method)
    try:
        async with asyncio.timeout(seconds):
            return await _exchange(host, port, body)
    except TimeoutError:
        raise RobotError("KG803", f"{uri} did not answer `{method}` within {seconds:g} s") from None
    except OSError as error:
        raise RobotError("KG803", f"{uri} cannot be reached: {error.strerror or error}") from None


def _only(uri: str, method: str, content: bytes) -> Any:
    values = xml_read(content)[1]
    if len(values) != 1:
        raise RobotError("KG810", f"{uri} answers `{method}` with {len(values)} values")
    return values[0]


async def _exchange(host: str, port: int, body: bytes) -> bytes:
    reader, writer = await asyncio.open_connection(host, port)
    try:
        head = f"POST /RPC2 HTTP/1.1\r\nHost: {netloc(host, port)}\r\nContent-Type: text/xml\r\nConnection: close\r\n"
        writer.write(f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body)
        first, fields = await _head(reader)
        if first.split(" ")[1:2] != ["200"]:
            raise RobotError("KG810", f"{host}:{port} answers `{first[:60]}`")
        return await _body(reader, fields, MOST_BYTES)
    finally:
        writer.close()


async def _head(reader: asyncio.StreamReader) -> tuple[str, dict[str, str]]:
    try:
        first, *lines = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1").strip().split("\r\n")
    except (asyncio.LimitOverrunError, asyncio.IncompleteReadError):
        raise RobotError("KG810", "a peer sent no whole header of HTTP") from None
    return first, {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}


async def _body(reader: asyncio.StreamReader, fields: dict[str, str], most: int) -> bytes:
    length = fields.get("content-length", "")
    if not length:
        content = bytearray()
        while len(content) <= most and (more := await reader.read(1 << 16)):
            content += more
    elif not length.isdecimal() or len(length) > 12 or int(length) > most:  # noqa: PLR2004 - digits, before int()
        raise RobotError("KG810", f"a peer announces a body of {length[:20]} bytes")
    else:
        try:
            return await reader.readexactly(int(length))
        except asyncio.IncompleteReadError as error:
            raise RobotError("KG810", f"a body ends after {len(error.partial)} of {length} bytes") from None
    if len(content) > most:
        raise RobotError("KG810", f"a peer sent a body of more than {most} bytes")
    return bytes(content)


async def listen(
    serve: Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]], host: str, port: int = 0
) -> asyncio.Server:
    """Listen at a host, at `::` on the same port for both protocols; OSError if that fails."""
    if host != "::":
        return await asyncio.start_server(serve, host, port, backlog=_BACKLOG)
    both = socket.create_server((host, port), family=socket.AF_INET6, dualstack_ipv6=True, backlog=_BACKLOG)
    return await asyncio.start_server(serve, sock=both, backlog=_BACKLOG)


class XmlRpcServer:
    """An XML-RPC server: `handle` receives method and arguments, and raises KeyError for an unknown method."""

    def __init__(self, handle: Callable[[str, list[Any]], Awaitable[Any]]) -> None:
        self._handle = handle
        self._server: asyncio.Server | None = None
        self._open: set[asyncio.StreamWriter] = set()
        self._answering = Tasks()

    async def start(self, host: str, port: int = 0) -> int:
        """Listen, and return the port; OSError if that fails."""
        self._server = await listen(self._serve, host, port)
        return int(self._server.sockets[0].getsockname()[1])

    async def aclose(self) -> None:
        """Stop the server."""
        if self._server is not None:
            self._server.close()
        for writer in list(self._open):
            writer.close()
        with suppress(TimeoutError):  # an event loop that stops first would report their cancellation
            async with asyncio.timeout(_ENDING):
                await self._answering.done()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._open.add(writer)
        if (task := asyncio.current_task()) is not None:
            self._answering.hold(task)
        try:
            while len(self._open) <= _MOST_CONNECTIONS and await self._answer(reader, writer):
                pass
        except (OSError, RobotError, TimeoutError):
            return  # the caller disconnected, or sends something else: nothing to respond to
        except asyncio.CancelledError:
            return  # the event loop stops; asyncio before 3.12 would log the cancellation
        finally:
            self._open.discard(writer)
            writer.close()

    async def _answer(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bool:
        """Respond to one call, and return whether the connection stays open."""
        async with asyncio.timeout(_IDLE):
            first, fields = await _head(reader)
        async with asyncio.timeout(_SLOWEST):
            body = await _body(reader, fields, _MOST_REQUEST) if "content-length" in fields else b""
        stays_open = first.endswith("HTTP/1.1") and fields.get("connection", "").lower() != "close"
        content = await self._result(body)
        head = f"HTTP/1.1 200 OK\r\nContent-Type: text/xml\r\nContent-Length: {len(content)}\r\n"
        writer.write(f"{head}Connection: {'keep-alive' if stays_open else 'close'}\r\n\r\n".encode() + content)
        async with asyncio.timeout(_SLOWEST):
            await writer.drain()
        return stays_open

    async def _result(self, body: bytes) -> bytes:
        try:
            method, arguments = xml_read(body)
            return _xml((await self._handle(method or "", arguments),))
        except RobotError as error:
            return _xml(client.Fault(1, error.message))
        except KeyError:
            return _xml(client.Fault(1, f"method {method!r} is not known"))
