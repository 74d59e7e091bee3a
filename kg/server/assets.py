"""`/static/...`: what the pages load, as files of the package."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from starlette.routing import Mount
from starlette.staticfiles import StaticFiles

if TYPE_CHECKING:
    from starlette.routing import BaseRoute

_FOLDER: Final = Path(__file__).parent

ROUTES: Final[list[BaseRoute]] = [
    Mount(f"/{name}", StaticFiles(directory=_FOLDER / name, check_dir=False)) for name in ("static", "vendor")
]
"""Our own files, and the libraries that `frontend/` puts there."""
