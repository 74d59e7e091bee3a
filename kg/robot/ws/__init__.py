"""Robots behind a bridge to WebSockets: `ws://HOST:PORT`, of Foxglove or rosbridge; `wss://` for encrypted ones.

    connection = await connect("ws://robot.local:8765", "/kg")     # foxglove_bridge
    connection = await connect("ws://robot.local:9090", "/kg")     # rosbridge_server

Which one it is, the subprotocol tells that the server chooses: Foxglove's have one, rosbridge has none.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from kg.errors import RobotError
from kg.robot.messages import Types  # noqa: TC001 - `connect` is looked up by its name
from kg.robot.ros2.names import absolute

if TYPE_CHECKING:
    from kg.robot.ws.connection import BridgeConnection

__all__ = ["connect"]

_HINT = "foxglove_bridge and rosbridge_server are bridges; the latter needs `rosapi`."
_OPENING = 5.0  # seconds that a server may take to answer
_PING = 3.0  # seconds between two questions whether the server is there, and that it may take to answer one
_LARGEST = 1 << 28  # bytes of a message, at most: a point cloud has some tens of millions


async def connect(address: str, name: str, types: Types | None = None) -> BridgeConnection:
    """Become a client of a bridge.

    Raises:
        RobotError: KG801 for an address of another form or where the library is not installed; KG802 when nobody
            answers there, or no bridge does.
    """
    own = absolute(name)
    try:
        from websockets.asyncio.client import connect as opened  # noqa: PLC0415 - an optional extra
        from websockets.exceptions import InvalidURI, WebSocketException  # noqa: PLC0415 - the same

        from kg.robot.ws.connection import BridgeConnection  # noqa: PLC0415 - the same
        from kg.robot.ws.foxglove import SUBPROTOCOLS, Foxglove  # noqa: PLC0415 - the same
        from kg.robot.ws.rosbridge import Rosbridge  # noqa: PLC0415 - the same
    except ImportError as error:
        hint = 'Install it with `pip install "kg-ros[ws]"`.'
        raise RobotError("KG801", f"the library for WebSockets is not installed: {error}", hint=hint) from None
    if not urlsplit(address).netloc:
        raise RobotError("KG801", f"`{address}` names no host", hint="Write ws://HOST:PORT.")
    try:
        socket = await opened(
            address,
            subprotocols=SUBPROTOCOLS,
            open_timeout=_OPENING,
            max_size=_LARGEST,
            ping_interval=_PING,
            ping_timeout=_PING,
        )
    except (InvalidURI, ValueError) as error:
        raise RobotError("KG801", f"`{address}` is not an address: {error}", hint="Write ws://HOST:PORT.") from None
    except (OSError, TimeoutError, WebSocketException) as error:
        raise RobotError("KG802", f"no bridge answers at {address}: {error}", hint=_HINT) from None
    bridge = (Rosbridge if socket.subprotocol is None else Foxglove)(socket.send, types)
    connection = BridgeConnection(socket, bridge, address, own)
    try:
        await asyncio.wait_for(connection.begin(), _OPENING)
    except TimeoutError:
        await connection.aclose()
        raise RobotError("KG802", f"{address} answers, but does not report what it bridges", hint=_HINT) from None
    except BaseException:
        await connection.aclose()
        raise
    return connection
