"""A process that has imported `kg` and forks for each run of Python, which then pays for its work, not for its imports.

    python -P forking.py 5 6        serve orders received on socket 5, and on connections to socket 6

An order is a working folder, the arguments of Python and an environment, as JSON, with files: the output streams of the
run, the pipe for its process number and then its exit code, and its input, if any. Its further keys are optional:
`modules` are imported before, for this run and all later ones; with `builds`, so is what builds need; with `session`,
the run has a session of its own. Each run is a process like that of a new Python, with streams, folder, environment and
exit of its own. This process opens no store and starts no thread, which makes forking safe.
"""

from __future__ import annotations

import atexit
import gc
import importlib
import json
import os
import pkgutil
import runpy
import select
import signal
import socket
import struct
import sys
import threading
from contextlib import suppress
from pathlib import Path
from types import ModuleType
from typing import Any, Final, NoReturn, TextIO

import kg.cli.commands

__all__ = ["ANSWER"]

ANSWER: Final = struct.Struct(">i")
"""A process number, or an exit code."""

_MOST: Final = 1 << 20
"""Maximum size of an order in bytes."""
_LATER: Final = (
    "kg.cli.commands.query",
    "kg.cli.app",
    "kg.cli.commands.build",
    "kg.cli.links",
    "kg.lint.running",
    "kg.pipeline.build",
    "kg.query.core",
    "kg.query.stored",
    "kg.rules.notations",
    "kg.store.embedded",
    "kg.views.why",
)
"""Modules imported lazily by the commands that tests run most."""
_BUILDING: Final = {"build", "demo"}
"""Commands that read workspaces, tag their texts and run rules."""
_BUILDERS: Final = (
    "kg.extract.package",
    "kg.pipeline.pool",
    "kg.pipeline.systems",
    "kg.pipeline.writing",
    "kg.rules.running",
)
"""Modules imported lazily by these commands."""
_ROBOTS: Final = (
    "kg.cli.commands.robot_driving",
    "kg.cli.commands.robot_programs",
    "kg.robot.driving.doing",
    "kg.robot.driving.watchdog",
    "kg.robot.programs.runner",
    "kg.robot.ros1",
)
"""Modules imported lazily by `kg robot`."""
_NOT_WRITTEN: Final = 120
"""The exit code of Python if its streams cannot be flushed at exit."""
_TESTS: Final = str(Path(__file__).parent)


def _serve(orders: socket.socket, callers: socket.socket) -> None:
    """Import the modules, then fork for each order until the socket is closed."""
    for module in pkgutil.iter_modules(kg.cli.commands.__path__, "kg.cli.commands."):
        importlib.import_module(module.name)
    for name in _LATER:
        importlib.import_module(name)
    gc.freeze()
    running: dict[int, tuple[int, int]] = {}  # by the descriptor of each process: its number, and the pipe for answers
    while True:
        # A handler of SIGCHLD could come just before a read that blocks, and would wait until the read ends.
        ready, _, _ = select.select([orders.fileno(), callers.fileno(), *running], [], [])
        for process in running.keys() & set(ready):
            _report(*running.pop(process))
            os.close(process)
        if orders.fileno() in ready:
            content, files, _, _ = socket.recv_fds(orders, _MOST, 4)
            if not content:
                return
        elif callers.fileno() in ready:
            with callers.accept()[0] as caller:
                content, files, _, _ = socket.recv_fds(caller, _MOST, 4)
        else:
            continue
        order = json.loads(content)
        for name in (*order.get("modules", ()), *(_ROBOTS if "robot" in order["python"] else ())):
            importlib.import_module(name)
        if order.get("builds") or _BUILDING & set(order["python"]):
            _prepare_builds()
        child = os.fork()
        if not child:
            orders.close()
            callers.close()
            for process, (_, answers) in running.items():
                os.close(process)
                os.close(answers)
            out, err, answers, *given = files
            os.close(answers)
            for stream in given:
                os.dup2(stream, sys.stdin.fileno())
                os.close(stream)
            _attend(order, out, err)
        out, err, answers, *given = files
        for stream in (out, err, *given):
            os.close(stream)
        os.write(answers, ANSWER.pack(child))
        running[os.pidfd_open(child)] = child, answers


def _report(child: int, answers: int) -> None:
    """Write the exit code of a run that has ended to the pipe of its order; a test that gave up has closed it."""
    _, status = os.waitpid(child, 0)
    with suppress(BrokenPipeError):
        os.write(answers, ANSWER.pack(os.waitstatus_to_exitcode(status)))
    os.close(answers)


def _prepare_builds() -> None:
    """Import the modules of builds, and load the tagger, the calls and the rules into this process.

    A run reloads rules whose files have changed.
    """
    for name in _BUILDERS:
        importlib.import_module(name)
    sys.path.insert(0, _TESTS)  # absent from the path of runs
    workspaces = importlib.import_module("workspaces")
    sys.path.remove(_TESTS)
    workspaces.prepare_builds()
    workspaces.prepare_rules()
    gc.freeze()


def _attend(order: dict[str, Any], out: int, err: int) -> None:
    """Execute a run in this process, with its streams and exit code."""
    if order.get("session"):
        os.setsid()
    sys.stdout, sys.stderr = _stream(out, sys.stdout), _stream(err, sys.stderr)
    _end(_run(order))


def _stream(file: int, like: TextIO) -> TextIO:
    """Redirect a stream to the file; the buffer type of an existing stream depends on its original file."""
    os.dup2(file, like.fileno())
    os.close(file)
    return open(
        like.fileno(), "w", 1 if like.line_buffering else -1, encoding=like.encoding, errors=like.errors, closefd=False
    )


def _run(order: dict[str, Any]) -> int:
    """Execute the module, the text or the file that the arguments of Python name; return the exit code."""
    os.chdir(order["folder"])
    os.environ.clear()
    os.environ.update(order["environment"])
    given = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    sys.path[:0] = [path for path in given if path and path not in sys.path]
    try:
        _execute(*order["python"])
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        sys.stderr.write(f"{end.code}\n")
        return 1
    except BaseException as error:  # noqa: BLE001 - as the interpreter does
        sys.excepthook(*sys.exc_info())
        return -signal.SIGINT if isinstance(error, KeyboardInterrupt) else 1
    return 0


def _execute(option: str, *arguments: str) -> None:
    """Execute a module after `-m`, a text after `-c`, or a file, with the arguments that follow."""
    if option == "-m":
        sys.argv = list(arguments)
        sys.path.insert(0, str(Path.cwd()))
        runpy.run_module(arguments[0], run_name="__main__", alter_sys=True)
    elif option == "-c":
        sys.argv = ["-c", *arguments[1:]]
        sys.path.insert(0, "")
        sys.modules["__main__"] = ModuleType("__main__")
        exec(compile(arguments[0], "<string>", "exec"), vars(sys.modules["__main__"]))  # noqa: S102 - the text of a test
    else:
        sys.argv = [option, *arguments]
        sys.path.insert(0, str(Path(option).parent))
        runpy.run_path(option, run_name="__main__")


def _end(code: int) -> NoReturn:
    """Exit like the interpreter, without its last step.

    That step visits every object of the parent process, which would copy all its memory.
    """
    threading._shutdown()  # type: ignore[attr-defined] # as the interpreter does: it ends pools, and waits for threads
    atexit._run_exitfuncs()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError:
        code = _NOT_WRITTEN
    if code == -signal.SIGINT:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGINT)
    os._exit(code)


if __name__ == "__main__":
    _serve(*(socket.socket(fileno=int(number)) for number in sys.argv[1:]))
