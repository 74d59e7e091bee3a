"""Robots behind a WebSocket bridge: `ws://HOST:PORT`, of Foxglove or rosbridge; `wss://` for encrypted ones.

    connection = await connect("ws://robot.local:8765", "/kg")     # foxglove_bridge
    connection = await connect("ws://robot.local:9090", "/kg")     # rosbridge_server

The subprotocol that the server selects distinguishes them: Foxglove bridges have one, rosbridge has none.
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
_OPENING = 5.0  # seconds to wait for an answer of a server
_PING = 3.0  # interval and timeout of pings in seconds
_LARGEST = 1 << 28  # maximum size of a message in bytes: a point cloud has some tens of millions


async def connect(address: str, name: str, types: Types | None = None) -> BridgeConnection:
    """Connect to a bridge as a client.

    Raises:
        RobotError: KG801 an invalid address or missing library; KG802 no answer, or not a bridge.
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
