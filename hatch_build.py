"""The build hook: put the libraries of the pages into `kg/server/vendor` before a package is made or installed.

Without Node.js or the network a source distribution is not made, for it is what a release is made from. A wheel that is
made for one machine is, with a warning: its pages work without pictures and without the editor.
"""

from __future__ import annotations

import os
from contextlib import suppress
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

__all__ = ["LibrariesHook"]

_REQUIRED = "KG_REQUIRE_LIBRARIES"
"""A variable of the environment that holds a wheel to what holds for a source distribution."""


class LibrariesHook(BuildHookInterface[Any]):
    """Runs `frontend/build.py` unless what it makes is there."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002 - the hook's interface
        """Build what is missing; where that cannot be done, fail or warn."""
        problem = _problem(Path(self.root, "frontend", "build.py"))
        if not problem:
            return
        words = f"the pages of `kg serve` have no pictures and a plain editor: {problem}"
        if self.target_name == "sdist" or os.environ.get(_REQUIRED):
            self.app.abort(f"{words}. Install Node.js with npm and build again.")
        self.app.display_warning(words)
        # pip shows nothing of a build that succeeds.
        with suppress(OSError), Path("/dev/tty").open("w") as terminal:
            terminal.write(f"\nwarning: {words}. Install Node.js with npm and run pip again; `kg doctor` checks it.\n")


def _problem(path: Path) -> str:
    """Build the libraries unless they are there; return why that cannot be done, empty where it is done."""
    spec = spec_from_file_location("kg_frontend_build", path)
    if not path.is_file() or spec is None or spec.loader is None:
        return f"{path} is missing"
    libraries = module_from_spec(spec)
    spec.loader.exec_module(libraries)
    try:
        if not libraries.current():
            libraries.build()
    except (libraries.BuildError, OSError) as error:
        return str(error)
    return ""
