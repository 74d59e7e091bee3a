"""Readers that fail at a row that the query names in a comment: `# crash@3`."""

from __future__ import annotations

import dataclasses
import os
import re
import sys
import time
from typing import TYPE_CHECKING, Any

from kg.query import evaluation as real
from kg.query.evaluation import Evaluation, Prepared
from kg.query.readers.forkserver import main

if TYPE_CHECKING:
    from collections.abc import Iterator

EVALUATE = Prepared.evaluate


def fail(how: str) -> None:
    """Fail in the way named."""
    if how == "crash":
        os.abort()
    elif how == "hang":
        time.sleep(60)
    elif how == "engine":
        message = "The custom function <x:f> is not supported"
        raise RuntimeError(message)
    elif how == "disk":
        message = "the disk is gone"
        raise OSError(message)
    elif how == "memory":
        raise MemoryError
    elif how == "abort":
        sys.stderr.write("memory allocation of 1073741824 bytes failed\n")
        sys.stderr.flush()
        os.abort()


def failing(found: Iterator[Any], how: str, row: int) -> Iterator[Any]:
    """Yield results up to a row, then fail."""
    for number, item in enumerate(found):
        if number == row:
            fail(how)
        yield item
    fail(how)


def evaluate(self: Prepared, *arguments: Any) -> Evaluation:
    """Evaluate, failing as the comment specifies."""
    evaluation = EVALUATE(self, *arguments)
    told = re.search(r"# (\w+)@(\d+)", self.typed)
    if told is None:
        return evaluation
    if isinstance(evaluation.result, bool):
        list(real._guarded(failing(iter(()), told[1], 0)))
        return evaluation
    return dataclasses.replace(evaluation, result=real._guarded(failing(evaluation.result, told[1], int(told[2]))))


if __name__ == "__main__":
    Prepared.evaluate = evaluate  # type: ignore[assignment,method-assign]  # to fail where the test wants it
    main()
