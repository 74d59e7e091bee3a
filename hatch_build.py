"""The build hook: put the libraries of the pages into `kg/server/vendor` before a package is made or installed.

Without Node.js or the network a source distribution is not made, for it is what a release is made from. A wheel that is
made for one machine is, with a warning: its pages work without pictures and without the editor.

With `KG_COMPILE=1` in the environment the interpreter and the C++ front end are compiled (`hatch_compile.py`), and the
wheel is for one platform. An editable installation stays as it is, so that changes of the code have an effect.
"""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

__all__ = ["PackageHook"]

_REQUIRED = "KG_REQUIRE_LIBRARIES"
"""A variable of the environment that holds a wheel to what holds for a source distribution."""
_COMPILE = "KG_COMPILE"


class PackageHook(BuildHookInterface[Any]):
    """Runs `frontend/build.py` unless what it makes is there, and `hatch_compile.py` where that is wanted."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return what the environment of the build needs."""
        return list(self._compiler().REQUIRED) if self._compiles() else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build what is missing; where that cannot be done, fail or warn."""
        problem = _problem(Path(self.root, "frontend", "build.py"))
        if problem:
            self._report(problem)
        if self._compiles() and version == "standard":
            self._compile(build_data)

    def _report(self, problem: str) -> None:
        words = f"the pages of `kg serve` have no pictures and a plain editor: {problem}"
        if self.target_name == "sdist" or os.environ.get(_REQUIRED):
            self.app.abort(f"{words}. Install Node.js with npm and build again.")
        self.app.display_warning(words)
        # pip shows nothing of a build that succeeds.
        with suppress(OSError), Path("/dev/tty").open("w") as terminal:
            terminal.write(f"\nwarning: {words}. Install Node.js with npm and run pip again; `kg doctor` checks it.\n")

    def _compiles(self) -> bool:
        return self.target_name == "wheel" and os.environ.get(_COMPILE, "0") not in ("", "0")

    def _compiler(self) -> Any:
        return _loaded(Path(self.root, "hatch_compile.py"))

    def _compile(self, build_data: dict[str, Any]) -> None:
        compiler = self._compiler()
        self._folder = tempfile.TemporaryDirectory(prefix="kg-compile-")
        try:
            libraries = compiler.build(Path(self.root), Path(self._folder.name))
        except (compiler.CompileError, OSError) as error:
            self.app.abort(f"kg was not compiled: {error}\nInstall a C compiler, or build without {_COMPILE}.")
        build_data["force_include"].update({str(path): name for path, name in libraries.items()})
        build_data.update(pure_python=False, infer_tag=True)

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:  # noqa: ARG002
        """Remove what was compiled, which is in the wheel now."""
        if hasattr(self, "_folder"):
            self._folder.cleanup()


def _loaded(path: Path) -> Any:
    """Return a script of the checkout as a module; None where it is missing."""
    spec = spec_from_file_location(f"kg_{path.parent.name}_{path.stem}", path)
    if not path.is_file() or spec is None or spec.loader is None:
        return None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _problem(path: Path) -> str:
    """Build the libraries unless they are there; return why that cannot be done, empty where it is done."""
    libraries = _loaded(path)
    if libraries is None:
        return f"{path} is missing"
    try:
        if not libraries.current():
            libraries.build()
    except (libraries.BuildError, OSError) as error:
        return str(error)
    return ""
