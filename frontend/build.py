"""Install the libraries that the pages load and copy them, with their licences, to `kg/server/vendor`.

    python frontend/build.py

The build hook (`hatch_build.py`) runs the same for wheels, source distributions and editable installs. Needs Node.js
with npm. What is copied is what `package.json` depends on, and what that needs: of each package the one file that is
its ES module, unchanged, and the text of its licence. `manifest.json` beside them says what is there. Blockly has no
such module: its core is copied as the classic script that it is, with its words in English and its pictures.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, Final

__all__ = ["BuildError", "build", "current"]

HERE: Final = Path(__file__).resolve().parent
VENDOR: Final = HERE.parent / "kg" / "server" / "vendor"
LOCK: Final = HERE / "package-lock.json"
SECONDS: Final = 240
"""How long npm may take."""
_SMALLER: Final = {"cytoscape": "dist/cytoscape.esm.min.mjs", "cytoscape-dagre": "dist/cytoscape-dagre.min.mjs"}
"""Packages with a minified module beside the one that they name."""
_CLASSIC: Final = {"blockly": "blockly_compressed.js"}
"""Packages that are loaded as a script of their own, and stand in no import map."""
_BESIDE: Final = {"blockly": ("msg/en.js", "media/*.svg", "media/*.cur", "media/*.gif")}
"""Further files of a package, as patterns."""
_RELATIVE: Final = re.compile(r"""^(?:import|export)\b[^'"\n]*['"]\.""", re.MULTILINE)


class BuildError(Exception):
    """Why the libraries could not be built, in one sentence."""


def current() -> bool:
    """Return whether `kg/server/vendor` holds what the lock file names."""
    try:
        manifest = json.loads((VENDOR / "manifest.json").read_text("utf-8"))
    except (OSError, ValueError):
        return False
    files = [VENDOR / one["name"] / file for one in manifest["libraries"] for file in (one["file"], one["notice"])]
    return bool(manifest["lock"] == _digest(LOCK) and all(file.is_file() for file in files))


def build() -> list[str]:
    """Install and copy; return the packages as `name version`. BuildError when that cannot be done."""
    _install()
    shutil.rmtree(VENDOR, ignore_errors=True)
    libraries = [_copy(name) for name in _shipped()]
    imports = {one["name"]: f"/vendor/{one['name']}/{one['file']}" for one in libraries if one["name"] not in _CLASSIC}
    manifest = {"lock": _digest(LOCK), "libraries": libraries, "imports": imports}
    (VENDOR / "manifest.json").write_text(json.dumps(manifest, indent=2) + "\n", "utf-8")
    return [f"{one['name']} {one['version']}" for one in libraries]


def _install() -> None:
    npm = shutil.which("npm")
    if npm is None:
        raise BuildError("Node.js with npm is not installed")
    # Peers are what Blockly needs outside of browsers: an emulation of one, which is larger than all the rest.
    command = [npm, "ci", "--ignore-scripts", "--legacy-peer-deps", "--no-audit", "--no-fund"]
    command += ["--loglevel=error", "--fetch-retries=1"]
    try:
        outcome = subprocess.run(  # noqa: S603 - npm of this machine, with fixed arguments
            command, cwd=HERE, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=SECONDS, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise BuildError(f"npm did not end within {SECONDS} s") from error
    if outcome.returncode:
        raise BuildError(f"npm ci failed: {' '.join(outcome.stderr.split())[:300]}")


def _shipped() -> list[str]:
    """Return the packages that the pages depend on, and those that these need, sorted."""
    waiting = list(_package(HERE)["dependencies"])
    found: set[str] = set()
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += _package(HERE / "node_modules" / name).get("dependencies", {})
    return sorted(found)


def _copy(name: str) -> dict[str, Any]:
    """Copy one package's module and licence; return what the manifest says of it."""
    folder = HERE / "node_modules" / name
    package = _package(folder)
    module = folder / (_CLASSIC.get(name) or _SMALLER.get(name) or _module(package))
    if _RELATIVE.search(module.read_text("utf-8")):
        raise BuildError(f"{name} consists of several modules: name one in frontend/build.py that stands alone")
    notice = next((path for path in sorted(folder.iterdir()) if path.name.upper().startswith("LICEN")), None)
    if notice is None:
        raise BuildError(f"{name} has no file with its licence")
    target = VENDOR / name
    target.mkdir(parents=True)
    for path in (module, notice):
        shutil.copyfile(path, target / path.name)
    for path in (found for pattern in _BESIDE.get(name, ()) for found in folder.glob(pattern)):
        (target / path.parent.name).mkdir(exist_ok=True)
        shutil.copyfile(path, target / path.parent.name / path.name)
    return {
        "name": name,
        "version": package["version"],
        "licence": package["license"],
        "file": module.name,
        "notice": notice.name,
        "bytes": module.stat().st_size,
        "sha256": _digest(module),
    }


def _module(package: dict[str, Any]) -> str:
    """Return the path of the ES module that a package names."""
    exports = package.get("exports", {})
    named = exports.get(".", exports) if isinstance(exports, dict) else exports
    return str(named.get("import") if isinstance(named, dict) else package["module"])


def _package(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "package.json").read_text("utf-8"))
    return found


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


if __name__ == "__main__":
    try:
        print("\n".join(build()))  # noqa: T201 - a program's answer
    except BuildError as problem:
        sys.exit(f"the libraries of the pages were not built: {problem}")
