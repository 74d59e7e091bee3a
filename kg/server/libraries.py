"""The libraries that pages load in the browser: which are installed, their licences and addresses.

`frontend/build.py` installs them into `kg/server/vendor`. Without them, pages show tables instead of pictures, and a
plain text field instead of the editor.
"""

from __future__ import annotations

import base64
import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Final

import msgspec

from kg.server.addresses import url

HELP: Final = (
    "Releases of kg have them. For an installation from sources install Node.js with npm, then run"
    " `python frontend/build.py` there, and install again."
)
_VENDOR: Final = Path(__file__).parent / "vendor"


class Library(msgspec.Struct, frozen=True):
    """A package: `file` is the module, `notice` the file with the text of its licence."""

    name: str
    version: str
    licence: str
    file: str
    notice: str


class _Manifest(msgspec.Struct):
    libraries: tuple[Library, ...] = ()
    imports: dict[str, str] = msgspec.field(default_factory=dict)


@cache
def _manifest() -> _Manifest:
    try:
        return msgspec.json.decode((_VENDOR / "manifest.json").read_bytes(), type=_Manifest)
    except (OSError, msgspec.MsgspecError):
        return _Manifest()


def libraries() -> tuple[Library, ...]:
    """Return the installed libraries by name; empty if they were not built."""
    return _manifest().libraries


def import_map() -> str:
    """Return the text of the pages' import map, from the name of each library to its address on this server."""
    return json.dumps({"imports": {name: url(path) for name, path in _manifest().imports.items()}}, sort_keys=True)


def source_of(import_map: str) -> str:
    """Return the source expression of a Content-Security-Policy that allows an import map: `'sha256-...'`."""
    digest = hashlib.sha256(import_map.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
