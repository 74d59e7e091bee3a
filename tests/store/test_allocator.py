"""Tests of returning freed memory."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FREED = """
from pathlib import Path
from threading import Thread
from kg.store.allocator import give_back

def held():
    return int(Path("/proc/self/statm").read_text().split()[1])

def take():
    blocks = [bytearray(100_000) for _ in range(300)]
    kept.append(bytes(2000))
    return blocks

kept: list[bytes] = []
threads = [Thread(target=take) for _ in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
before = held()
give_back()
print(before - held())
"""


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="Linux tells what a process holds there")
def test_freed_memory_goes_back() -> None:
    """Memory freed by threads is returned to the system."""
    found = subprocess.run([sys.executable, "-c", FREED], capture_output=True, text=True, check=True)
    assert int(found.stdout) > 100
