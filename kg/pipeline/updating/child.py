"""Process of a `Writer`: `python -m kg.pipeline.updating.child` makes changes until its input is closed."""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path
from typing import BinaryIO, Final

import msgspec

from kg.pipeline.updating.applying import Applier
from kg.pipeline.updating.changes import Change
from kg.query.readers.messages import Call, Configuration, Message, failure, frame, received
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout

_STACK_BYTES: Final = 256 << 20
"""The engine recurses over an update. Updates that pass the guards need less stack (reserved, not used)."""

_SAVED_EVERY: Final = 16
"""Number of changes after which the memory of the rules is saved; a killed process loses at most these."""

_CHANGES: Final = msgspec.msgpack.Decoder[Change](Change)


def _serve(requests: BinaryIO, answers: BinaryIO) -> None:
    """Make one change after the other until the input is closed."""
    configuration = received(requests)
    if not isinstance(configuration, Configuration):
        return
    settings = load({"store": configuration.root, **configuration.settings})
    applier = Applier(EmbeddedStore(Layout(Path(configuration.root))), settings)
    _cap_memory(configuration.memory)
    applier.warm()
    while isinstance(request := received(requests), Call):
        answer: Message | bytes
        try:
            answer = msgspec.msgpack.encode(applier.apply(_CHANGES.decode(request.arguments["change"])))
        except Exception as error:  # noqa: BLE001 - one change must not end the others
            answer = failure(error, "update")
        answers.write(frame(answer))
        answers.flush()
        if applier.unsaved >= _SAVED_EVERY:
            applier.save()
    applier.save()


def _cap_memory(most: int | None) -> None:
    """Limit the address space of this process; the engine aborts the process at the limit. Only on Linux."""
    import resource  # noqa: PLC0415 - not on every system

    if most is not None and sys.platform == "linux":
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def main() -> None:
    """Serve until standard input is closed; all prints go to standard error."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    threading.stack_size(_STACK_BYTES)
    thread = threading.Thread(target=_serve, args=(sys.stdin.buffer, answers), daemon=True)
    thread.start()
    # The threads that read and load columns need no large stack.
    threading.stack_size(0)
    thread.join()


if __name__ == "__main__":
    main()
