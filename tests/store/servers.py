"""SPARQL servers for tests: one of Oxigraph on a free port of this machine, and one that answers as it is told."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from patience import patient
from ports import own_port

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["oxigraph_server"]


@contextmanager
def oxigraph_server() -> Iterator[str]:
    """Run `oxigraph serve` in memory and yield its address; skip the test where the program is not installed."""
    # pip puts it beside the Python that runs the tests, which need not be on the path.
    program = shutil.which("oxigraph", path=str(Path(sys.executable).parent)) or shutil.which("oxigraph")
    if program is None:
        pytest.skip("oxigraph is not installed (pip install oxigraph)")
    with own_port() as port:
        address = f"127.0.0.1:{port}"
        command = [program, "serve", "--bind", address]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            _wait(f"http://{address}/")
            yield f"http://{address}"
        finally:
            process.terminate()
            process.wait()


def _wait(address: str) -> None:
    end = time.monotonic() + patient(10)
    while time.monotonic() < end:
        try:
            with urllib.request.urlopen(address, timeout=patient(5)):  # noqa: S310 - a server of the test
                return
        except OSError:
            time.sleep(0.05)
    pytest.fail("oxigraph did not start")
