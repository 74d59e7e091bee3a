"""Connection headers and messages of TCPROS as bytes (wiki.ros.org/ROS/TCPROS and ROS/Connection%20Header)."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Mapping
from typing import Final

from kg.errors import RobotError

MOST_BYTES: Final = 1 << 26
"""Maximum size of a received message: an image of 64 MiB."""

_MOST_HEADER: Final = 1 << 20
_LENGTH: Final = struct.Struct("<I")


def framed(content: bytes) -> bytes:
    """Return content prefixed with its length."""
    return _LENGTH.pack(len(content)) + content


def pack(fields: Mapping[str, str]) -> bytes:
    """Return an encoded header prefixed with its length."""
    return framed(b"".join(framed(f"{name}={value}".encode()) for name, value in fields.items()))


def unpack(content: bytes) -> dict[str, str]:
    """Return the fields of a header; RobotError KG810 for invalid bytes."""
    fields: dict[str, str] = {}
    at = 0
    while at < len(content):
        end = at + 4 + (_LENGTH.unpack_from(content, at)[0] if at + 4 <= len(content) else len(content))
        name, equals, value = content[at + 4 : end].decode(errors="replace").partition("=")
        if end > len(content) or not equals or not name:
            raise RobotError("KG810", f"a header of {len(content)} bytes is broken at byte {at}")
        fields[name] = value
        at = end
    return fields


async def read_header(reader: asyncio.StreamReader, seconds: float = 5.0) -> dict[str, str]:
    """Return the header sent by a peer; RobotError KG810 an invalid header, KG803 timeout or the connection ends."""
    try:
        async with asyncio.timeout(seconds):
            content = await read_message(reader, _MOST_HEADER)
    except TimeoutError:
        raise RobotError("KG803", f"a peer sent no header within {seconds:g} s") from None
    if content is None:
        raise RobotError("KG803", "a peer ended the connection without a header")
    return unpack(content)


async def read_message(reader: asyncio.StreamReader, most: int = MOST_BYTES) -> bytes | None:
    """Return the next message, None at the end of the connection; RobotError KG810 if it is too long or truncated."""
    try:
        (length,) = _LENGTH.unpack(await reader.readexactly(4))
    except asyncio.IncompleteReadError as error:
        if error.partial:
            raise RobotError("KG810", "a message ends within its length") from None
        return None
    if length > most:
        raise RobotError("KG810", f"a message of {length} bytes is announced; more than {most} are not received")
    try:
        return await reader.readexactly(length)
    except asyncio.IncompleteReadError as error:
        raise RobotError("KG810", f"a message ends after {len(error.partial)} of {length} bytes") from None
