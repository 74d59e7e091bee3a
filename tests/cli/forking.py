"""A process that has imported `kg` and forks for each run of it, so that a run costs what it does, not what it imports.

    python -P forking.py 5          serve orders that come on the socket with the number 5

An order is a working folder, arguments and an environment, as JSON; three files come along: the streams of the run, and
where to say its process number and then its exit code. Each run is a process like that of `python -m kg`, with streams,
folder, environment and exit of its own. This process opens no store and starts no thread, which makes forking safe.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import pkgutil
import runpy
import signal
import socket
import struct
import sys
from typing import Any, Final, TextIO

import kg.cli.commands
from kg.language.annotating import prepare
from kg.pipeline.reasoning import rules_in_force
from kg.settings import load

__all__ = ["ANSWER"]

ANSWER: Final = struct.Struct(">i")
"""A process number, or an exit code."""

_MOST: Final = 1 << 20
"""Bytes of an order."""
_LATER: Final = (
    "kg.pipeline.build",
    "kg.query.ask",
    "kg.cli.answers",
    "kg.cli.links",
    "kg.lint.running",
    "kg.views.why",
)
"""What commands import when they run, for those that tests run most."""
_BUILDING: Final = {"build", "demo"}
"""Commands that read workspaces, tag what is written there and run rules."""
_BUILDERS: Final = ("kg.pipeline.pool", "kg.extract.package", "kg.rules.running")
"""What these import when they run."""


def _serve(orders: socket.socket) -> None:
    """Import, then fork for each order until the socket is closed."""
    for module in pkgutil.iter_modules(kg.cli.commands.__path__, "kg.cli.commands."):
        importlib.import_module(module.name)
    for name in _LATER:
        importlib.import_module(name)
    gc.freeze()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    while True:
        content, files, _, _ = socket.recv_fds(orders, _MOST, 3)
        if not content:
            return
        order = json.loads(content)
        if _BUILDING & set(order["arguments"]):
            _prepare_builds()
        if not os.fork():
            orders.close()
            _attend(order, *files)
        for file in files:
            os.close(file)


def _prepare_builds() -> None:
    """Import what builds need, and read the tagger and the rules, all of which this process keeps.

    A run reads rules again where their files have changed.
    """
    for name in _BUILDERS:
        importlib.import_module(name)
    prepare()
    rules_in_force(load({}, environment={}), [])
    gc.freeze()


def _attend(order: dict[str, Any], out: int, err: int, answers: int) -> None:
    """Fork what runs, tell its number and how it ended, and end."""
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    child = os.fork()
    if not child:
        os.close(answers)
        sys.stdout, sys.stderr = _stream(out, sys.stdout), _stream(err, sys.stderr)
        _run(order)
    os.close(out)
    os.close(err)
    os.write(answers, ANSWER.pack(child))
    _, status = os.waitpid(child, 0)
    os.write(answers, ANSWER.pack(os.waitstatus_to_exitcode(status)))
    os._exit(0)


def _stream(file: int, like: TextIO) -> TextIO:
    """Let a stream lead to the file; what was opened for another may hold its kind."""
    os.dup2(file, like.fileno())
    os.close(file)
    return open(
        like.fileno(), "w", 1 if like.line_buffering else -1, encoding=like.encoding, errors=like.errors, closefd=False
    )


def _run(order: dict[str, Any]) -> None:
    """Be `python -m kg`."""
    os.chdir(order["folder"])
    os.environ.clear()
    os.environ.update(order["environment"])
    sys.argv = ["kg", *order["arguments"]]
    sys.path.insert(0, order["folder"])
    runpy.run_module("kg", run_name="__main__", alter_sys=True)
    sys.exit()


if __name__ == "__main__":
    _serve(socket.socket(fileno=int(sys.argv[1])))
