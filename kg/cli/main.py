"""Entry point of the program `kg`."""

from __future__ import annotations

import gc
import os
import sys
from contextlib import suppress

from kg.lazily import lazily

with lazily():
    from kg.cli.supervising import address_space, is_out_of_memory, supervise


def run() -> None:
    """Run the command line of this process; even errors during imports end in a line or two."""
    try:
        _run()
    finally:
        # Python keeps in mind that Ctrl-C came while a text was executed, as when methods of data classes are made, and
        # `python -m` then ends by the signal, whatever was done about it and with which code. This is another text.
        with suppress(MemoryError):  # a memory limit ended the command
            exec("")  # noqa: S102 - nothing


def _run() -> None:
    _mend_streams()
    # Commands create many objects and little garbage: a collection every 700 objects costs a fifth of the time.
    gc.set_threshold(100_000)
    # Before numpy is loaded: matrices are small here, and its threads would only spin.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from kg.cli.supervising import MemoryLimitError  # noqa: PLC0415 - as below

    try:
        if address_space():
            supervise()
        from kg.cli.app import app  # noqa: PLC0415 - so that what goes wrong while this loads is caught
    except (KeyboardInterrupt, Exception) as error:  # noqa: BLE001 - Ctrl-C, or a damaged installation
        if was_interrupted(error):
            sys.stderr.write("\ninterrupted\n")
            sys.exit(130)
        from kg.cli.diagnostics import defect, report  # noqa: PLC0415 - the branch that needs it

        if isinstance(error, MemoryLimitError) or is_out_of_memory(error):
            limit = MemoryLimitError("KG004", "the command failed to allocate memory")
            report(error if isinstance(error, MemoryLimitError) else limit)
            sys.exit(limit.exit_code)
        defect(error)
        sys.exit(70)
    app()


def was_interrupted(error: BaseException) -> bool:
    """Return whether an error is Ctrl-C, or its disguise in class definitions before Python 3.12."""
    return isinstance(error, KeyboardInterrupt) or isinstance(error.__cause__, KeyboardInterrupt)


def _mend_streams() -> None:
    """Ensure that both streams exist (`>&-` closes them) and accept any character, escaped if necessary."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115, PTH123 - for the whole process
        else:
            stream.reconfigure(errors="backslashreplace")
