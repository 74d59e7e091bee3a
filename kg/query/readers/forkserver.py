"""Fork server of the readers: `python -m kg.query.readers.forkserver [MODULE...]`.

It imports the modules that readers need, and those named on the command line, so a new reader takes milliseconds
instead of the third of a second of a new Python. The modules listed in their `MODULES` are imported while it is idle.
Forking is safe because it opens no store and starts no threads. Orders come on standard input, a socket, as `ORDER`:
fork a reader (with two files: the socket to serve, and its standard error), or kill it, pause it, resume it, or lower
its priority. The owner chooses the number of a reader. Each reader is a session of its own, so its niceness is compared
with all processes of the machine. If the machine runs out of memory, Linux kills readers before other processes.

Readers exit with their owner: on Linux by a signal of the system, elsewhere they check once a second.
"""

from __future__ import annotations

import gc
import os
import selectors
import signal
import socket
import struct
import sys
import threading
import traceback
from collections.abc import Iterable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Final, NoReturn

from kg.lazily import lazily
from kg.query.readers.child import serve

with lazily():
    import ctypes

ORDER: Final = struct.Struct(">cI")
"""An order, and the number of the reader."""

FORK: Final = b"F"
END: Final = b"E"
PAUSE: Final = b"P"
RESUME: Final = b"R"
YIELD: Final = b"Y"
_SIGNALS: Final = {END: signal.SIGKILL, PAUSE: signal.SIGSTOP, RESUME: signal.SIGCONT}

_NICENESS: Final = 10
"""Niceness of readers with long queries (nice(2)). With more they would starve on a busy machine, such as a robot."""

_STACK_BYTES: Final = 256 << 20
"""The engine recurses over the query. Queries that pass `kg.query.guard` need less stack (reserved, not used)."""
_IDLE_SECONDS: Final = 0.5
"""Seconds without orders before the next module is imported."""
_DIE_WITH_PARENT: Final = 1
"""PR_SET_PDEATHSIG of prctl(2)."""


class _ForkServer:
    """Process IDs of readers by number, and the socket for orders."""

    def __init__(self, orders: socket.socket, modules: Iterable[str]) -> None:
        self._orders = orders
        self._modules = list(modules)
        self._readers: dict[int, int] = {}

    def run(self) -> None:
        """Execute orders until the socket is closed; then kill all readers."""
        ended, wake = socket.socketpair()
        for one in (ended, wake):
            one.setblocking(False)
        signal.set_wakeup_fd(wake.fileno(), warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        with selectors.DefaultSelector() as selector:
            selector.register(self._orders, selectors.EVENT_READ)
            selector.register(ended, selectors.EVENT_READ)
            while True:
                ready = {key.fileobj for key, _ in selector.select(_IDLE_SECONDS if self._modules else None)}
                if not ready:
                    # Errors are ignored: the reader that needs the module reports them.
                    with suppress(Exception):
                        import_module(self._modules.pop())
                    gc.freeze()
                if ended in ready:
                    ended.recv(4096)
                    self._reap()
                if self._orders in ready and not self._execute([ended, wake]):
                    break
        for pid in self._readers.values():
            os.kill(pid, signal.SIGKILL)

    def _execute(self, private: list[socket.socket]) -> bool:
        """Execute one order; return false at the end of the stream."""
        data, files, _, _ = socket.recv_fds(self._orders, ORDER.size, 2)
        if len(data) < ORDER.size:
            return False
        what, number = ORDER.unpack(data)
        if what == FORK:
            # If no process can be forked, the files are closed, which the owner detects.
            with suppress(OSError):
                self._readers[number] = os.fork() or _become_reader(files, [self._orders, *private])
            for file in files:
                os.close(file)
        elif number in self._readers and what == YIELD:
            _lower_priority(self._readers[number])
        elif number in self._readers:
            os.kill(self._readers[number], _SIGNALS[what])
        return True

    def _reap(self) -> None:
        """Reap exited readers; their process IDs may be reused."""
        with suppress(ChildProcessError):
            while (pid := os.waitpid(-1, os.WNOHANG)[0]) != 0:
                self._readers = {number: other for number, other in self._readers.items() if other != pid}


def _lower_priority(pid: int) -> None:
    """Lower the priority of a reader."""
    with suppress(OSError):
        # On Linux, the niceness of a process applies to its first thread; that of a group applies to all threads.
        os.setpriority(os.PRIO_PGRP, pid, _NICENESS)
    with suppress(OSError):
        # If Linux groups processes by session, niceness counts only within the group (sched(7), autogroup).
        Path(f"/proc/{pid}/autogroup").write_text(str(_NICENESS))


def _become_reader(files: list[int], private: list[socket.socket]) -> NoReturn:
    """Serve on the files of the order, in the forked process; does not return."""
    status = 1
    try:
        owner = os.getppid()
        os.setsid()
        with suppress(OSError):
            Path("/proc/self/oom_score_adj").write_text("1000")
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        for one in private:
            one.close()
        os.dup2(files[1], 1)
        os.dup2(files[1], 2)
        os.close(files[1])
        _die_with_parent()
        threading.stack_size(_STACK_BYTES)
        link = socket.socket(fileno=files[0])
        thread = threading.Thread(target=serve, args=(link.makefile("rb"), link.makefile("wb")), daemon=True)
        thread.start()
        # Other threads need no large stack, and address space is limited.
        threading.stack_size(0)
        while thread.is_alive() and os.getppid() == owner:
            thread.join(1)
        status = 0
    finally:
        if error := sys.exception():
            traceback.print_exception(error)
        # Skip the exit handlers inherited from the fork server.
        os._exit(status)


def _die_with_parent() -> None:
    """On Linux, have the system kill this process when its parent exits."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)


def main() -> None:
    """Fork readers until standard input is closed."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    orders = socket.socket(fileno=os.dup(0))
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    _die_with_parent()
    named = [import_module(name) for name in sys.argv[1:]]
    gc.freeze()
    _ForkServer(orders, [name for module in named for name in getattr(module, "MODULES", ())]).run()


if __name__ == "__main__":
    main()
