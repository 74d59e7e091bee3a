"""A thread that waits for something to happen in a participant, and tells the event loop.

Callbacks of the library into Python are avoided altogether: its threads would wait for the interpreter's lock while
they hold locks of the library, for which a call of ours would wait that holds the interpreter's lock.
"""

from __future__ import annotations

import asyncio
import threading
from typing import TYPE_CHECKING, Final

from cyclonedds.core import GuardCondition, WaitSet
from cyclonedds.util import duration

if TYPE_CHECKING:
    from collections.abc import Callable

    from cyclonedds.core import Entity
    from cyclonedds.domain import DomainParticipant

__all__ = ["Bell", "delete"]

_EVER: Final = duration(infinite=True)


def delete(entity: Entity) -> None:
    """Delete an entity of DDS now, not when Python collects it."""
    entity.__del__()


class Bell:
    """What rings in the loop when the status of an entity has changed."""

    def __init__(self, participant: DomainParticipant) -> None:
        self.participant = participant
        self._loop = asyncio.get_running_loop()
        self._set = WaitSet(participant)
        self._stop = GuardCondition(participant)
        self._set.attach(self._stop)
        self._calls: dict[int, tuple[Entity, int, Callable[[], None]]] = {}
        self._heard = threading.Event()
        self._closed = False
        self._thread = threading.Thread(target=self._wait, name="kg-dds", daemon=True)
        self._thread.start()

    def add(self, entity: Entity, mask: int, call: Callable[[], None]) -> None:
        """Have `call` called in the loop when a status of the mask has changed."""
        entity.set_status_mask(mask)
        self._calls[id(entity)] = (entity, mask, call)
        self._set.attach(entity)

    def remove(self, entity: Entity) -> None:
        """Call for an entity no more."""
        if not self._closed and self._calls.pop(id(entity), None) is not None:
            self._set.detach(entity)

    def _wait(self) -> None:
        """Wait, tell the loop, and wait until it has heard: a status stays set until it is taken."""
        while not self._closed:
            self._set.wait(_EVER)
            self._heard.clear()
            try:
                self._loop.call_soon_threadsafe(self._ring)
            except RuntimeError:
                return  # the loop was closed without closing the connection
            self._heard.wait()

    def _ring(self) -> None:
        try:
            for entity, mask, call in list(self._calls.values()):
                if not self._closed and id(entity) in self._calls and entity.take_status(mask):
                    call()
        finally:
            self._heard.set()

    def close(self) -> None:
        """End the thread."""
        self._closed = True
        self._stop.set(True)
        while self._thread.is_alive():
            self._heard.set()
            self._thread.join(0.01)
        delete(self._set)
