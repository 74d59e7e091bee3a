"""pybullet and OpenCV, loaded where a simulation begins: they are the extra `simulate`."""

from __future__ import annotations

import ctypes
import os
import sys
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["opencv", "physics"]

_STREAMS: Final = (1, 2)


def physics() -> Any:
    """Return a new physics server of pybullet without a window; RobotError KG840 when pybullet is not installed."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    with _silence():
        bullet = _loaded("pybullet")
        return _loaded("pybullet_utils.bullet_client").BulletClient(bullet.DIRECT)


def opencv() -> Any:
    """Return OpenCV with its dictionaries of tags; RobotError KG840 when it is not installed."""
    return _loaded("cv2")


def _loaded(module: str) -> Any:
    try:
        return import_module(module)
    except ImportError:
        name = "opencv-python-headless" if module == "cv2" else "pybullet"
        hint = "Install the extra: pip install 'kg-ros[simulate]'"
        raise RobotError("KG840", f"the simulation needs {name}, which is not installed", hint=hint) from None


@contextmanager
def _silence() -> Iterator[None]:
    """Keep the greetings of pybullet's C code from the terminal, and off stdout, which is for data."""
    flush = ctypes.CDLL(None).fflush
    kept = [os.dup(stream) for stream in _STREAMS]
    nothing = os.open(os.devnull, os.O_WRONLY)
    try:
        flush(None)
        for stream in _STREAMS:
            os.dup2(nothing, stream)
        yield
    finally:
        flush(None)
        for stream, copy in zip(_STREAMS, kept, strict=True):
            os.dup2(copy, stream)
            os.close(copy)
        os.close(nothing)
