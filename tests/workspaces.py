"""Stores of the example workspace, built once for a whole run of tests, whatever the number of its workers."""

from __future__ import annotations

import fcntl
import os
import shutil
from typing import TYPE_CHECKING

from kg.pipeline.build import build
from kg.resources import folder
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

__all__ = ["copied", "example"]


def example(factory: pytest.TempPathFactory, name: str = "examples") -> Path:
    """Return a folder with a copy of the example workspace, called `name`, and its store, `.kg`; both are only read.

    Outside of any checkout, so that the names of sources do not depend on where the tests stand. The workers of
    pytest-xdist share it: the first one that asks builds, the others wait.
    """
    own = factory.getbasetemp()
    root = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / f"built-{name}"
    with root.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (root / ".kg" / "current").exists():
            shutil.rmtree(root, ignore_errors=True)
            shutil.copytree(folder("examples") / "workspace", root / name)
            build([str(root / name)], EmbeddedStore.create(root / ".kg"), load({}, environment={}))
    return root


def copied(store: Path, target: Path) -> None:
    """Copy the folder of a store that others use, without what they are just writing to its cache, which goes soon."""
    shutil.copytree(store, target, ignore=shutil.ignore_patterns("*.tmp"))
