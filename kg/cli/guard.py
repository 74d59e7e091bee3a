"""The boundary between commands and the shell: all outcomes become an exit code and at most a few lines of text.

An invalid command line becomes an error like all others, with a suggestion.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable
from typing import Any

from typer import Abort
from typer.exceptions import TyperException

from kg.cli.diagnostics import defect, report, say
from kg.cli.main import was_interrupted
from kg.cli.supervising import MemoryLimitError, is_out_of_memory
from kg.errors import Exit, KgError, StoreError, UsageError
from kg.similar import did_you_mean


def as_usage_error(error: TyperException) -> UsageError:
    """Return KG003 for an error of typer about the arguments."""
    context: Any = getattr(error, "ctx", None)
    see = f"See `{context.command_path} --help`." if context else "See `kg --help`."
    message = error.message if hasattr(error, "option_name") else error.format_message()
    near = getattr(error, "possibilities", None)
    hint = did_you_mean(getattr(error, "option_name", ""), near) if near else None
    sentence = " ".join(message.split()).rstrip(".")
    lowered = sentence[:1].lower() + sentence[1:]
    return UsageError("KG003", lowered, hint="\n".join(filter(None, (hint, see))))


def guarded(work: Callable[[], object]) -> int:
    """Run a command and return the exit code of the process (`kg.errors.Exit`)."""
    try:
        result = work()
        sys.stdout.flush()
    except BrokenPipeError:
        return hang_up()
    except (KeyboardInterrupt, Abort):
        result = Exit.INTERRUPTED
    except Exception as error:  # noqa: BLE001 - the one place where everything ends
        if not was_interrupted(error):
            return _show(error)
        result = Exit.INTERRUPTED
    if result == Exit.INTERRUPTED:
        say("\ninterrupted")
    return int(result) if isinstance(result, int) else Exit.OK


def hang_up() -> int:
    """Stop writing to standard output: its reader has closed it, or the disk is full."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return Exit.OK


def _show(error: Exception) -> int:
    if isinstance(error, TyperException):
        error = as_usage_error(error)
    elif isinstance(error, OSError) and error.errno == errno.ENOSPC:
        if error.filename is None:
            hang_up()
        error = StoreError("KG304", f"no space left on the device ({error.filename or 'output'})")
    elif not isinstance(error, KgError) and is_out_of_memory(error):
        error = MemoryLimitError("KG004", "the command failed to allocate memory")
    if isinstance(error, KgError):
        report(error)
        return error.exit_code
    defect(error)
    return Exit.INTERNAL
