"""Writer of one store, for asyncio: makes changes one at a time, in the order of the requests.

async with Writer(layout, settings) as writer:
    updated = await writer.update("INSERT DATA { <urn:a> <urn:b> <urn:c> }", seconds=60)
    updated.snapshot                                        "13"

A process that can be killed makes the changes: at a deadline, at the memory limit or after a crash of the engine the
store is unchanged. The process remains for the next change, because loading the rules takes longer than most changes.
"""

from __future__ import annotations

import asyncio
import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Self

import msgspec

from kg.errors import QueryError
from kg.pipeline.updating.changes import Change, GraphChange, Update, Updated
from kg.query.readers.messages import PREFIX, Call, Configuration, Failure, decode, frame
from kg.query.runner import DeadlineError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.settings import Settings
    from kg.store.layout import Layout

_MEMORY: Final = 8 << 30
_MOVED: Final = "The data changed just then: look whether it was by this update."
_PATIENCE: Final = 5.0
"""Time limit for saving before the process is killed, in seconds."""


class Writer:
    """Writes one store; at most `queue` changes wait. `memory` limits the address space of its process in bytes."""

    def __init__(self, layout: Layout, settings: Settings, *, queue: int = 16, memory: int | None = _MEMORY) -> None:
        self.layout = layout
        self._configuration = Configuration(str(layout.root), memory, "", settings.chosen())
        self._queue = queue
        self._waiting = 0
        self._turn = asyncio.Lock()
        self._process: asyncio.subprocess.Process | None = None

    async def __aenter__(self) -> Self:
        await self._ready()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self._stop()

    @property
    def process(self) -> int | None:
        """Process ID of the writer process; None if not running."""
        running = self._process is not None and self._process.returncode is None
        return self._process.pid if self._process is not None and running else None

    async def update(  # noqa: PLR0913 - all but three by name
        self,
        text: str,
        using: Sequence[str] = (),
        using_named: Sequence[str] = (),
        *,
        base: str | None = None,
        seconds: float | None = 60,
        snapshot: str | None = None,
    ) -> Updated:
        """Run a SPARQL update; its operations are atomic.

        `using` and `using_named` are those of the protocol. Relative IRIs are resolved against `base`. `snapshot`
        requires data of that identity.

        Raises:
            KgError: KG501 syntax, KG502 refused, KG503 deadline, KG507 memory limit, KG509 too many wait, KG512 another
                snapshot, KG302 while another process writes, KG560 a graph exists already or does not exist, KG561 a
                graph of kg's own, KG565 `using` combined with USING or WITH, KG568 the process exited. The store is
                then unchanged.
        """
        change = Update(text=text, using=tuple(using), using_named=tuple(using_named), base=base, snapshot=snapshot)
        return await self.apply(change, seconds=seconds)

    async def put_graph(  # noqa: PLR0913 - all but three by name
        self,
        graph: str | None,
        body: bytes | Sequence[tuple[bytes, str]],
        media_type: str = "",
        *,
        base: str | None = None,
        seconds: float | None = 60,
        snapshot: str | None = None,
    ) -> Updated:
        """Replace the content of a graph (None: the default graph); `Updated.created` is true for a new one.

        `body` is RDF of `media_type` (or the name of a format), or several parts, each with its own. Raises as
        `update`, and KG562 for content that does not parse, KG563 for a format that is not for a single graph.
        """
        return await self.apply(_graph_change("put", graph, body, media_type, base, snapshot), seconds=seconds)

    async def post_graph(  # noqa: PLR0913 - all but three by name
        self,
        graph: str | None,
        body: bytes | Sequence[tuple[bytes, str]],
        media_type: str = "",
        *,
        base: str | None = None,
        seconds: float | None = 60,
        snapshot: str | None = None,
    ) -> Updated:
        """Add content to a graph, created if missing; arguments and errors as `put_graph`."""
        return await self.apply(_graph_change("post", graph, body, media_type, base, snapshot), seconds=seconds)

    async def delete_graph(
        self, graph: str | None, *, seconds: float | None = 60, snapshot: str | None = None
    ) -> Updated:
        """Remove a graph, or clear the default graph (None); raises as `update`, and KG564 if it does not exist."""
        return await self.apply(GraphChange(action="delete", graph=graph, snapshot=snapshot), seconds=seconds)

    async def apply(self, change: Change, *, seconds: float | None = 60) -> Updated:
        """Make a change; the deadline counts from here, including the wait. Raises as `update`."""
        if self._waiting > self._queue:
            raise QueryError("KG509", f"{self._waiting} updates run or wait already", hint="Try again in a second.")
        self._waiting += 1
        base: int | None = None
        current = base
        try:
            async with asyncio.timeout(seconds or None), self._turn:
                base = self.layout.current()
                try:
                    return await self._run(change)
                finally:
                    current = self.layout.current()
        except TimeoutError:
            message = f"the update took longer than {seconds:g} s"
            hint = _MOVED if current != base else "Change less at once, or raise the timeout."
            raise DeadlineError("KG503", message, hint=hint) from None
        finally:
            self._waiting -= 1

    async def _run(self, change: Change) -> Updated:
        """Send a change to the process; on cancellation the process is killed."""
        process = await self._ready()
        whole = False
        try:
            answer = await _request(process, Call("apply", {"change": msgspec.msgpack.encode(change)}))
            whole = True
        finally:
            if not whole:
                await self._kill()
        if isinstance(answer, Failure):
            raise answer.error()
        return msgspec.msgpack.decode(answer, type=Updated)

    async def _ready(self) -> asyncio.subprocess.Process:
        """Return the process, restarted if it has exited."""
        if self._process is None or self._process.returncode is not None:
            self._process = await asyncio.create_subprocess_exec(
                sys.executable, "-P", "-m", "kg.pipeline.updating.child",
                stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
                env={**os.environ, "PYTHONUNBUFFERED": "1"},
            )  # fmt: skip
            assert self._process.stdin is not None  # noqa: S101 - started with a pipe
            self._process.stdin.write(frame(self._configuration))
        return self._process

    async def _stop(self) -> None:
        """Make the process save the memory of the rules and exit; it is killed at the time limit."""
        if self._process is not None and self._process.stdin is not None and not self._turn.locked():
            self._process.stdin.close()
            with suppress(TimeoutError):
                await asyncio.wait_for(self._process.wait(), _PATIENCE)
        await self._kill()

    async def _kill(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()


async def _request(process: asyncio.subprocess.Process, request: Call) -> bytes | Failure:
    """Send a request and return the response of the process."""
    assert process.stdin is not None  # noqa: S101 - started with a pipe
    assert process.stdout is not None  # noqa: S101 - the same
    try:
        process.stdin.write(frame(request))
        await process.stdin.drain()
        length, kind = PREFIX.unpack(await process.stdout.readexactly(PREFIX.size))
        answer = decode(kind, await process.stdout.readexactly(length))
    except (asyncio.IncompleteReadError, ConnectionError):
        message = "the process that makes changes ended; the store is as it was"
        raise QueryError("KG568", message, hint="Change less at once, or raise its memory.") from None
    return answer if isinstance(answer, bytes | Failure) else Failure("KG568", "no answer")


def _graph_change(  # noqa: PLR0913, PLR0917 - the inputs of a graph change
    action: Any,
    graph: str | None,
    body: bytes | Sequence[tuple[bytes, str]],
    media_type: str,
    base: str | None,
    snapshot: str | None,
) -> GraphChange:
    parts = ((body, media_type),) if isinstance(body, bytes) else tuple(body)
    return GraphChange(action=action, graph=graph, parts=parts, base=base, snapshot=snapshot)
