"""The build hook: put the libraries of the pages into `kg/server/vendor` before a package is made or installed.

Without Node.js or the network the package is made all the same; its pages then work without pictures and without the
editor, and say how to get them.
"""

from __future__ import annotations

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

__all__ = ["LibrariesHook"]


class LibrariesHook(BuildHookInterface[Any]):
    """Runs `frontend/build.py` unless what it makes is there."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002 - the hook's interface
        """Build what is missing; a warning when that cannot be done."""
        path = Path(self.root, "frontend", "build.py")
        spec = spec_from_file_location("kg_frontend_build", path)
        if not path.is_file() or spec is None or spec.loader is None:
            return
        libraries = module_from_spec(spec)
        spec.loader.exec_module(libraries)
        if libraries.current():
            return
        try:
            libraries.build()
        except (libraries.BuildError, OSError) as error:
            self.app.display_warning(f"the pages get no libraries: {error}")
