"""The libraries of the pages."""

from __future__ import annotations

import hashlib
import json

import pytest
from repository import ROOT

from kg.server import libraries
from kg.server.libraries import Library

_FRONTEND = ROOT / "frontend"
_VENDOR = ROOT / "kg" / "server" / "vendor"
_BUILT = pytest.mark.skipif(not libraries.libraries(), reason=libraries.HELP)


def test_the_lock_file_names_no_registry() -> None:
    """Each package has its checksum; the installing machine chooses the registry."""
    lock = json.loads((_FRONTEND / "package-lock.json").read_text("utf-8"))
    packages = {name: one for name, one in lock["packages"].items() if name}
    assert all("resolved" not in one and one["integrity"].startswith("sha512-") for one in packages.values())
    assert "://registry" not in (_FRONTEND / "package-lock.json").read_text("utf-8")


@_BUILT
def test_each_library_is_whole_and_licensed() -> None:
    """Every file matches the manifest, is self-contained, and has its licence."""
    manifest = json.loads((_VENDOR / "manifest.json").read_text("utf-8"))
    for one in manifest["libraries"]:
        module = _VENDOR / one["name"] / one["file"]
        assert hashlib.sha256(module.read_bytes()).hexdigest() == one["sha256"]
        assert one["licence"] in {"MIT", "Apache-2.0"}
        assert "permission" in (_VENDOR / one["name"] / one["notice"]).read_text("utf-8").lower()


@_BUILT
def test_the_import_map_names_what_is_there() -> None:
    """Every name of the map leads to a file, and the policy's source is the hash of the map."""
    text = libraries.import_map()
    for address in json.loads(text)["imports"].values():
        assert (_VENDOR.parent / address.removeprefix("/")).is_file()
    assert libraries.source_of(text).startswith("'sha256-")
    assert {one.name for one in libraries.libraries()} >= {"cytoscape", "codemirror"}
    assert isinstance(libraries.libraries()[0], Library)


def test_without_a_build_there_is_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a build the map is empty, and pages explain how to get the libraries."""
    monkeypatch.setattr(libraries, "_VENDOR", ROOT / "nowhere")
    libraries._manifest.cache_clear()
    try:
        assert libraries.libraries() == ()
        assert json.loads(libraries.import_map()) == {"imports": {}}
        assert "Node.js" in libraries.HELP
    finally:
        libraries._manifest.cache_clear()
