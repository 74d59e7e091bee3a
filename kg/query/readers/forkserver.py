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
import resource
import selectors
import signal
import socket
import struct
import sys
import threading
import time
import traceback
from collections.abc import Iterable
from contextlib import suppress
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Final, NoReturn, cast

import msgspec
from pyoxigraph import Literal, NamedNode, Triple

from kg.errors import KgError, QueryError
from kg.lazily import lazily
from kg.query.evaluation import Dataset, Evaluation, Window, prepare
from kg.query.formats import unfit, write_boolean, write_graph, write_rows
from kg.query.readers import messages
from kg.query.readers.cache import Pointer
from kg.settings import Settings, load
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout
from kg.store.opening import take_layout
from kg.store.terms import of_spelling

if TYPE_CHECKING:
    from kg.query.result import Row
    from kg.store.snapshot import EmbeddedSnapshot


with lazily():
    import ctypes


_RESERVED_BYTES: Final = 1 << 30
"""Estimate of the reserved memory of a reader, for systems that do not report it."""
_LARGE_BYTES: Final = 512 << 20
"""A reader that uses more memory after a request is replaced."""
_PART_BYTES: Final = 64 << 10
_PROGRESS_SECONDS: Final = 0.1
_HARD_LIMIT: Final = resource.getrlimit(resource.RLIMIT_AS)[1]


def serve(requests: BinaryIO, answers: BinaryIO) -> None:
    """Answer `requests` until the end of the stream; the first message is a `Configuration`."""
    configuration = messages.received(requests)
    if not isinstance(configuration, messages.Configuration):
        return
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    reader = _Reader(configuration, answers)
    reader.begin()
    while (request := messages.received(requests)) is not None:
        if not reader.answer(request):
            return


class _Reader:
    """Reader of one store; it writes responses to `answers`."""

    def __init__(self, configuration: messages.Configuration, answers: BinaryIO) -> None:
        self._configuration = configuration
        self._layout = Layout(Path(configuration.root), configuration.address)
        take_layout(self._layout)
        self._pointer = Pointer(self._layout)
        self._answers = answers
        self._snapshot: EmbeddedSnapshot | None = None
        self._threads = threading.active_count()

    def begin(self) -> None:
        """Open the current data and report that requests may be sent."""
        self._refresh()
        self._send(messages.Ready(os.getpid()))

    def answer(self, request: messages.Message | bytes) -> bool:
        """Answer a request; return false if this process should not answer another one."""
        try:
            if isinstance(request, messages.Question):
                self._ask(request)
            elif isinstance(request, messages.Call):
                self._call(request)
            elif isinstance(request, messages.Refresh):
                self._refresh()
        except Exception as error:  # noqa: BLE001 - one request must not end the others
            self._send(msgspec.structs.replace(messages.failure(error, "query"), last=self._is_spent()))
            return not isinstance(error, MemoryError)
        return True

    def _ask(self, question: messages.Question) -> None:
        began = time.perf_counter()
        terms = {name: _term(name, text) for name, text in question.parameters.items()}
        prepared = prepare(question.text, terms, question.path)
        snapshot = self._current()
        if question.snapshot not in {None, snapshot.identity}:
            message = f"the data is no longer snapshot {question.snapshot}, but {snapshot.identity}"
            raise QueryError("KG512", message, hint="Ask again without a snapshot to see what holds now.")
        dataset = Dataset(question.union, question.default_graphs, question.named_graphs)
        evaluation = prepared.evaluate(snapshot, dataset, question.base)
        kind = evaluation.kind
        if kind not in question.formats:
            raise unfit(kind, *sorted(set(question.formats.values())))
        head = messages.Head(kind, question.formats[kind], snapshot.identity, evaluation.variables, prepared.repeatable)
        parts = Parts(self._answers, head, question.size)
        count, more = self._write(parts, head, evaluation, question)
        parts.end(self._end(count, began, more=more))

    def _write(
        self, parts: Parts, head: messages.Head, evaluation: Evaluation, question: messages.Question
    ) -> tuple[int, bool]:
        """Write the response; return the number of its rows, and whether there were more."""
        if isinstance(evaluation.result, bool):
            write_boolean(head.format, parts.take, value=evaluation.result)
            return 1, False
        pulse = Pulse(self._answers)
        window: Window[Any] = Window(evaluation.result, offset=question.offset, most=question.rows, tick=pulse.tick)
        if head.kind == "graph":
            write_graph(head.format, cast("Iterable[Triple]", window), parts.take)
        else:
            write_rows(head.format, evaluation.variables, cast("Iterable[Row]", window), parts.take)
        return window.count, window.more

    def _call(self, call: messages.Call) -> None:
        functions = import_module(self._configuration.calls).CALLS if self._configuration.calls else {}
        if call.name not in functions:
            raise QueryError("KG506", f"unknown view `{call.name}`")
        began = time.perf_counter()
        snapshot = self._current()
        result = functions[call.name](snapshot, self._settings, **call.arguments)
        parts = Parts(self._answers, messages.Head("json", "json", snapshot.identity, repeatable=False), None)
        parts.take(msgspec.json.encode(result))
        parts.end(self._end(1, began))

    @cached_property
    def _settings(self) -> Settings:
        return load({"store": self._configuration.address or self._configuration.root, **self._configuration.settings})

    def _end(self, count: int, began: float, *, more: bool = False) -> messages.End:
        """Return the end of a whole response."""
        return messages.End(count, time.perf_counter() - began, more, self._is_spent())

    def _is_spent(self) -> bool:
        """Return whether to replace this process, as a request left it with much memory or running threads."""
        return _resident_bytes() > _LARGE_BYTES or threading.active_count() > self._threads

    def _current(self) -> EmbeddedSnapshot:
        if self._snapshot is not None and self._snapshot.identity != self._pointer.snapshot():
            self._snapshot.close()
            self._snapshot = None
        if self._snapshot is None:
            _cap_memory(None)
            self._snapshot = EmbeddedStore(self._layout).read()
            _cap_memory(self._configuration.memory)
        return self._snapshot

    def _refresh(self) -> None:
        """Open the current data; ignore errors, because the next request reports them."""
        try:
            self._current()
        except (KgError, OSError):
            return

    def _send(self, message: messages.Message) -> None:
        self._answers.write(messages.frame(message))
        self._answers.flush()


def _term(name: str, text: str) -> NamedNode | Literal:
    """Return the term with the N-Triples syntax `text`; QueryError KG505 if it is not an IRI or literal."""
    try:
        term = of_spelling(text)
    except SyntaxError:
        term = None
    if not isinstance(term, NamedNode | Literal):
        raise QueryError("KG505", f"`{text}` for ?{name} is not an N-Triples term", hint='Write <iri> or "text".')
    return term


def _cap_memory(most: int | None) -> None:
    """Limit the address space to its current size plus `most` bytes; the engine aborts the process at the limit.

    Much of the current size is only reserved: stacks and the heaps of threads. The limit applies only on Linux: macOS
    refuses a limit below the hundreds of gigabytes that it reserves for each process.
    """
    if sys.platform != "linux":
        return
    now = _memory_bytes(0) or _RESERVED_BYTES
    wanted = _HARD_LIMIT if most is None else now + most
    bounded = wanted if _HARD_LIMIT == resource.RLIM_INFINITY else min(wanted, _HARD_LIMIT)
    resource.setrlimit(resource.RLIMIT_AS, (bounded, _HARD_LIMIT))


def _resident_bytes() -> int:
    """Return the resident memory of this process; 0 if the system does not report it or it was never large."""
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return _memory_bytes(1) if most << 10 > _LARGE_BYTES else 0


def _memory_bytes(column: int) -> int:
    statistics = Path("/proc/self/statm")
    return int(statistics.read_text().split()[column]) * resource.getpagesize() if statistics.exists() else 0


class Parts:
    """Buffers a response and sends it in parts, after the head; `most` limits its bytes in all.

    Errors before the first part is full are found before anything is sent.
    """

    def __init__(self, answers: BinaryIO, head: messages.Head, most: int | None) -> None:
        self._answers = answers
        self._head: messages.Head | None = head
        self._most = most
        self._size = 0
        self._buffered: list[bytes] = []
        self._buffered_bytes = 0

    def take(self, data: bytes) -> None:
        """Append to the response; QueryError KG511 if it exceeds the limit."""
        self._size += len(data)
        if self._most is not None and self._size > self._most:
            hint = "Ask for fewer rows, with LIMIT."
            raise QueryError("KG511", f"the answer has more than {self._most:,} bytes", hint=hint)
        self._buffered.append(data)
        self._buffered_bytes += len(data)
        if self._buffered_bytes >= _PART_BYTES:
            self._send()

    def end(self, end: messages.End) -> None:
        """Send the buffer and the end of the response as one piece."""
        self._send(messages.frame(end))

    def _send(self, end: bytes = b"") -> None:
        head = b"" if self._head is None else messages.frame(self._head)
        part = messages.frame(b"".join(self._buffered)) if self._buffered else b""
        self._answers.write(head + part + end)
        self._answers.flush()
        self._head, self._buffered, self._buffered_bytes = None, [], 0


class Pulse:
    """Sends the number of rows, at most ten times a second."""

    def __init__(self, answers: BinaryIO) -> None:
        self._answers = answers
        self._next = time.monotonic() + _PROGRESS_SECONDS

    def tick(self, count: int) -> None:
        """Send `count` if the last message is old enough."""
        now = time.monotonic()
        if now >= self._next:
            self._answers.write(messages.frame(messages.Progress(count)))
            self._answers.flush()
            self._next = now + _PROGRESS_SECONDS


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
