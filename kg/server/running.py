"""Running the server until it is told to stop."""

from __future__ import annotations

import gc
from functools import partial
from typing import TYPE_CHECKING

import uvicorn

from kg.server import logs
from kg.server.app import create_app
from kg.server.safety import starting
from kg.server.safety.connections import guarded
from kg.server.stopping import Server

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.applications import Starlette

    from kg.server.options import Options
    from kg.settings import Settings


def serve(settings: Settings, options: Options, announce: Callable[[str], None] = lambda _address: None) -> None:
    """Serve the store of the settings until a signal ends it; `announce` is told the address.

    Raises:
        StoreError: KG301 there is no store.
        UsageError: KG540 others would get in, KG541 the token cannot be used, KG542 the address is taken.
    """
    starting.check(options)
    app = create_app(settings, options)
    listening = starting.listen(options)
    logs.configure()
    config = uvicorn.Config(
        app,
        http=guarded(options.connections, options.root_path),
        ws="none",
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
    )
    host = f"[{options.host}]" if ":" in options.host else options.host
    ready = partial(_begin, announce, f"http://{host}:{listening.getsockname()[1]}{options.root_path}/")
    server = Server(
        config,
        grace=options.grace,
        ready=ready,
        leave=partial(_leave, app),
        suspend=partial(_suspend, app),
        end=partial(_end, app),
    )
    server.run(sockets=[listening])


def _begin(announce: Callable[[str], None], address: str) -> None:
    """Announce the address; what was loaded until now is never garbage, and need not be looked at again."""
    gc.freeze()
    announce(address)


async def _leave(app: Starlette) -> None:
    """Stop the robot before anything else."""
    if hasattr(app.state, "server") and app.state.server.robot is not None:
        await app.state.server.robot.leave()


async def _suspend(app: Starlette) -> None:
    """Stop the robot before the process is suspended."""
    if hasattr(app.state, "server") and app.state.server.robot is not None:
        await app.state.server.robot.suspend()


def _end(app: Starlette) -> None:
    """End all that runs."""
    if hasattr(app.state, "server"):
        readers = app.state.server.readers
        for identity in tuple(readers.jobs):
            readers.cancel(identity)
