"""Views for the tests of readers, in the form of `kg.views.calls`."""

from __future__ import annotations

import os
import threading
import time
from typing import Any, Final

from kg.errors import QueryError

__all__ = ["CALLS"]


def _work(_snapshot: Any, _settings: Any, seconds: float | str) -> dict[str, int]:
    end = time.process_time() + float(seconds)
    while time.process_time() < end:
        pass
    return {"niceness": os.nice(0), "process": os.getpid()}


def _stack(_snapshot: Any, _settings: Any) -> dict[str, int]:
    return {"bytes": threading.stack_size()}


def _leave(_snapshot: Any, _settings: Any) -> dict[str, int]:
    threading.Thread(target=time.sleep, args=(600,), daemon=True).start()
    return {"process": os.getpid()}


def _fail(snapshot: Any, settings: Any) -> None:
    raise QueryError("KG506", str(_leave(snapshot, settings)["process"]))


CALLS: Final = {"fail": _fail, "leave": _leave, "stack": _stack, "work": _work}
