"""The process that readers are forked from: `python -m kg.query.readers.forkserver [MODULE...]`.

It has imported what readers need, and the modules named, so that a new reader costs milliseconds instead of the third
of a second that a new Python would; what these modules name as their `MODULES` it imports when no orders come. It holds
no store and starts no thread, which is what makes forking safe. Orders
come on standard input, a socket, as `ORDER`: `fork` a reader (two files come along: the socket to serve, and where
errors go), or end it, pause it, resume it, or lower its priority; a reader is known by the number that its owner chose.
Each is a session of its own, so that its niceness is one among all processes of the machine. When the machine runs out
of memory, Linux ends readers before any other process.

Nothing outlives its owner: where the system has no word for that (Linux has), readers look once a second.
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
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final, NoReturn

from kg.query.readers.child import serve

if TYPE_CHECKING:
    from collections.abc import Iterable

ORDER: Final = struct.Struct(">cI")
"""What is to be done, and the number of the reader."""

FORK: Final = b"F"
END: Final = b"E"
PAUSE: Final = b"P"
RESUME: Final = b"R"
YIELD: Final = b"Y"
_SIGNALS: Final = {END: signal.SIGKILL, PAUSE: signal.SIGSTOP, RESUME: signal.SIGCONT}

_NICENESS: Final = 10
"""The priority of long queries (nice(2)). With a lower one they would not end on a busy machine, such as a robot."""

_STACK_BYTES: Final = 256 << 20
"""The engine recurses over the query; what `kg.query.guard` lets through needs less than this (reserved, not used)."""
_LEISURE: Final = 0.5
"""Seconds without orders, before anything else is done."""
_DIE_WITH_PARENT: Final = 1
"""PR_SET_PDEATHSIG of prctl(2)."""


class _ForkServer:
    """Readers by number, and the socket that orders come on."""

    def __init__(self, orders: socket.socket, modules: Iterable[str]) -> None:
        self._orders = orders
        self._modules = list(modules)
        self._readers: dict[int, int] = {}

    def run(self) -> None:
        """Do what is ordered until the orders end; then every reader ends too."""
        ended, wake = socket.socketpair()
        for one in (ended, wake):
            one.setblocking(False)
        signal.set_wakeup_fd(wake.fileno(), warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        with selectors.DefaultSelector() as selector:
            selector.register(self._orders, selectors.EVENT_READ)
            selector.register(ended, selectors.EVENT_READ)
            while True:
                ready = {key.fileobj for key, _ in selector.select(_LEISURE if self._modules else None)}
                if not ready:
                    self._load_another()
                if ended in ready:
                    ended.recv(4096)
                    self._bury()
                if self._orders in ready and not self._obey([ended, wake]):
                    break
        for pid in self._readers.values():
            os.kill(pid, signal.SIGKILL)

    def _load_another(self) -> None:
        """Import one module that readers may need; that it cannot be is for the reader to say that needs it."""
        with suppress(Exception):
            import_module(self._modules.pop())
        gc.freeze()

    def _obey(self, private: list[socket.socket]) -> bool:
        """Carry out one order; false when there are no more."""
        data, files, _, _ = socket.recv_fds(self._orders, ORDER.size, 2)
        if len(data) < ORDER.size:
            return False
        what, number = ORDER.unpack(data)
        if what == FORK:
            # Where the system has no room for another process, the files are closed, which its owner sees.
            with suppress(OSError):
                self._readers[number] = os.fork() or _become_reader(files, [self._orders, *private])
            for file in files:
                os.close(file)
        elif number in self._readers and what == YIELD:
            _give_way(self._readers[number])
        elif number in self._readers:
            os.kill(self._readers[number], _SIGNALS[what])
        return True

    def _bury(self) -> None:
        """Take note of readers that ended, so that their numbers stand for no other process."""
        with suppress(ChildProcessError):
            while (pid := os.waitpid(-1, os.WNOHANG)[0]) != 0:
                self._readers = {number: other for number, other in self._readers.items() if other != pid}


def _give_way(pid: int) -> None:
    """Lower the priority of a reader."""
    with suppress(OSError):
        # The niceness of a process is that of its first thread on Linux; that of a group is that of all threads.
        os.setpriority(os.PRIO_PGRP, pid, _NICENESS)
    with suppress(OSError):
        # Where Linux groups processes by session, niceness counts inside of the group alone (sched(7), autogroup).
        Path(f"/proc/{pid}/autogroup").write_text(str(_NICENESS))


def _become_reader(files: list[int], private: list[socket.socket]) -> NoReturn:
    """Serve on the files that came with the order; this is the child, and does not return."""
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
        # Threads of views need no such stack, and there is a bound on address space.
        threading.stack_size(0)
        while thread.is_alive() and os.getppid() == owner:
            thread.join(1)
        status = 0
    finally:
        if error := sys.exception():
            traceback.print_exception(error)
        # Nothing of the process that it was forked from is to be ended in an orderly way.
        os._exit(status)


def _die_with_parent() -> None:
    """Ask the system to end this process when the one that started it ends, where it can be asked."""
    if sys.platform == "linux":
        import ctypes  # noqa: PLC0415 - for Linux alone

        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)


def main() -> None:
    """Fork readers until standard input ends; whoever ends this process does so by closing that."""
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
