"""The application: its routes, shared state, start-up and shutdown.

A module of routes has `ROUTES`. Middlewares are in `kg.server.safety`; `kg.server.errors` turns errors into responses.
"""

from __future__ import annotations

from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles

from kg.errors import Place, StoreError, UsageError
from kg.pipeline.updating.writer import Writer
from kg.query.readers.pool import Readers
from kg.server import (
    errors,
    graph_store,
    jobs,
    methods,
    metrics,
    openapi,
    pages,
    protocol,
    protocol_update,
    safety,
    views,
)
from kg.server.addresses import Rooted
from kg.server.compression import Compressed
from kg.server.errors import HANDLERS
from kg.server.robot import routes as robot
from kg.server.robot.session import Session
from kg.server.safety import login
from kg.server.state import State
from kg.store.following import Following
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.server.options import Options
    from kg.settings import Settings

_FOLDER: Final = Path(__file__).parent


def create_app(settings: Settings, options: Options) -> Starlette:
    """Return the application that serves the store of the settings.

    Raises:
        StoreError: KG301 there is no store, KG225 the server that has the data does not answer, KG309 the data is on a
            server, and `options.write` is set.
        UsageError: KG002 the root path is the address of a page.
    """
    root = options.root_path
    taken = {route.path.split("/")[1] for route in _routes() if isinstance(route, Route | Mount)}
    if root and root.split("/")[1] in taken:  # `/store/x` might have lost a root path `/store`
        message = f"the root path {root} begins like an address of kg itself"
        raise UsageError("KG002", message, hint="Choose another one, for example /kg.")
    layout = layout_of(settings)
    if layout.address is not None:
        if options.write:
            hint = "Leave out --write, and send changes to the server itself."
            message = "`kg serve` does not change the data of another server"
            raise StoreError("KG309", message, place=Place(layout.name), hint=hint)
        Following(layout).check()

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        readers = Readers(
            layout,
            processes=options.readers,
            queue=options.queue,
            memory=options.memory,
            cache=options.cache,
            calls="kg.views.calls",
            prepare="prepare",
            settings=settings.chosen(),
        )
        async with readers, AsyncExitStack() as stack:
            writer = await stack.enter_async_context(Writer(layout, settings)) if options.write else None
            session = await stack.enter_async_context(Session(options.robot, settings)) if options.robot else None
            app.state.server = State(settings, options, readers, writer, session)
            yield

    outermost = [Middleware(Rooted, root=root)] if root else []
    app = Starlette(
        routes=_routes(),
        middleware=[*outermost, *safety.middleware(options), Middleware(protocol.Endpoint), Middleware(Compressed)],
        exception_handlers={**HANDLERS, 404: methods.not_found, 405: methods.not_allowed},
        lifespan=lifespan,
    )
    app.router.redirect_slashes = False  # to an address without the root path; `not_found` redirects instead
    return app


def _routes() -> list[BaseRoute]:
    """Return all routes, the most requested first, since they are tried in this order."""
    watching = (metrics, openapi, login, errors)
    before = (protocol, protocol_update, graph_store, jobs, *watching, robot, views)
    files = [Mount(f"/{name}", StaticFiles(directory=_FOLDER / name, check_dir=False)) for name in ("static", "vendor")]
    return [*(route for part in before for route in part.ROUTES), *files, *pages.ROUTES]
