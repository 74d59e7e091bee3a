"""A simulated robot from above: the picture that a simulation publishes of itself, for as long as somebody looks."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.tasks import ended

if TYPE_CHECKING:
    from kg.robot.connection import ComputationGraph, Connection

__all__ = ["LARGEST", "TOPIC", "Picture", "has_picture"]

TOPIC: Final = "/simulator/view"
"""Where `kg.robot.simulation` publishes it, which is not imported here because it loads the physics."""
_KIND: Final = "std_msgs/String"
LARGEST: Final = 1 << 20
"""How many characters a picture may have."""
_FIRST: Final = 5.0
"""Seconds to wait for the first picture."""
_UNSEEN: Final = 10.0
"""Seconds after which nobody looks any more."""


def has_picture(graph: ComputationGraph) -> bool:
    """Tell whether a simulation shows itself in a graph."""
    return any(one.role is Role.PUBLISHES and (one.name, one.type) == (TOPIC, _KIND) for one in graph.ends)


class Picture:
    """The newest picture; `aclose` before the connection is left."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._newest: asyncio.Future[str] | None = None
        self._task: asyncio.Task[None] | None = None
        self._seen = 0.0

    async def newest(self) -> str:
        """Return the newest picture as SVG; RobotError KG803 when none comes."""
        self._seen = asyncio.get_running_loop().time()
        if self._task is None or self._task.done() or self._newest is None:
            self._newest = asyncio.get_running_loop().create_future()
            self._task = asyncio.create_task(self._look())
        newest, looking = self._newest, self._task
        await asyncio.wait((newest, looking), timeout=_FIRST, return_when=asyncio.FIRST_COMPLETED)
        if newest.done():
            return newest.result()
        error = looking.exception() if looking.done() and not looking.cancelled() else None
        why = f": {error.message if isinstance(error, RobotError) else error}" if error else ""
        raise RobotError("KG803", f"the simulation shows no picture{why}") from error

    async def aclose(self) -> None:
        """Look no more."""
        if self._task is not None:
            await ended(self._task)

    async def _look(self) -> None:
        loop = asyncio.get_running_loop()
        subscription = await self._connection.subscribe(TOPIC, _KIND, queue=1)
        try:
            async for received in subscription:
                text = received.value["data"]
                if self._newest is not None and len(text) <= LARGEST:
                    if self._newest.done():
                        self._newest = loop.create_future()
                    self._newest.set_result(text)
                if loop.time() - self._seen > _UNSEEN:
                    return
        finally:
            await subscription.aclose()
