"""`git` with limits: disk usage and time are watched while it runs, and it is killed when a limit is exceeded.

Git runs in a process group of its own, so its helpers are killed with it, and Ctrl-C in a terminal reaches only `kg`.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.corpus.git import command, environment, without_password

if TYPE_CHECKING:
    from pathlib import Path
    from threading import Event

_NETWORK: Final = (
    *("-c", "credential.helper="),
    *("-c", "core.askPass="),
    *("-c", "http.followRedirects=initial"),
    *("-c", "submodule.recurse=false"),
    *("-c", "filter.lfs.smudge="),
    *("-c", "filter.lfs.process="),
    *("-c", "filter.lfs.required=false"),
    *("-c", "core.autocrlf=false"),
    *("-c", "transfer.fsckObjects=true"),
)
# Harmless errors of old tools, which are common in repositories.
_SLIPS: Final = (
    *("badTimezone", "badDate", "badEmail", "badName", "badFilemode", "nullSha1", "extraHeaderEntry"),
    *("missingSpaceBeforeDate", "missingSpaceBeforeEmail", "missingNameBeforeEmail", "missingEmail"),
    *("missingTaggerEntry", "multipleAuthors", "zeroPaddedFilemode", "zeroPaddedDate"),
    *("gitmodulesParse", "gitmodulesMissing"),
)
_HARMLESS: Final = tuple(word for name in _SLIPS for word in ("-c", f"fetch.fsck.{name}=ignore"))
_GONE: Final = re.compile(
    r"not found|does not appear to be a git repository|could not read Username|returned error: (?:401|403|404|410)"
    r"|Authentication failed|Permission denied \(|access denied|no such repository|not our ref|couldn't find remote ref"
    r"|does not exist",
    re.IGNORECASE,
)
_REFUSED: Final = re.compile(
    r"fsck|hasDot|gitmodules\w+:|invalid path|transport '.*' not allowed|disallowed|strange (?:host|pathname)"
    r"|beyond a symbolic link|not supported or disabled",
    re.IGNORECASE,
)
_PASSING: Final = re.compile(
    r"could not resolve host|connection (?:timed out|refused|reset)|timed? ?out|early EOF|disconnect|hung up"
    r"|returned error: (?:429|5\d\d)|RPC failed|TLS|SSL|temporary failure|unreachable|empty reply|failed to connect"
    r"|HTTP/2 stream|invalid index-pack|partial file|transfer closed|could not connect|unable to connect",
    re.IGNORECASE,
)
_IDLE: Final = ("warning:", "Could not read from remote", "Please make sure", "and the repository exists")
"""Prefixes of lines of git that do not contain the cause."""
_MOST_OUTPUT: Final = 64 << 20
_MOST_WORDS: Final = 8192
_FIRST_PAUSE: Final = 0.01
_LONGEST_PAUSE: Final = 0.25
_WEIGHING_SHARE: Final = 10
"""Measuring a folder may take a tenth of the time."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one repository: bytes on disk, total seconds, number of retries and the first pause."""

    bytes: int = 500 << 20
    seconds: float = 600.0
    retries: int = 3
    pause: float = 1.0


class FetchingError(Exception):
    """A repository was not fetched; `state` is the keyword of the reason, `passing` whether a retry might help."""

    def __init__(self, state: str, reason: str, *, passing: bool = False) -> None:
        super().__init__(reason)
        self.state = state
        self.reason = reason
        self.passing = passing


class StoppedError(Exception):
    """The work was cancelled: Ctrl-C."""


class Watch:
    """Runs `git` for one repository in the temporary folder `folder`, within limits, until `stop` is set."""

    def __init__(self, folder: Path, limits: Limits, stop: Event) -> None:
        """Start the clock."""
        self.folder = folder
        self.words = ""
        self._limits = limits
        self._stop = stop
        self._deadline = time.monotonic() + limits.seconds

    def wait(self, seconds: float) -> None:
        """Wait before a retry; StoppedError on cancellation, FetchingError after the time limit."""
        if time.monotonic() + seconds > self._deadline:
            raise self._late()
        if self._stop.wait(seconds):
            raise StoppedError

    def git(self, *arguments: str, within: Path, protocols: str = "none", given: bytes = b"") -> bytes:
        """Return the output of `git`, run in the folder `within` with `given` as its input.

        Afterwards `words` has its standard error.

        Raises:
            FetchingError: git failed, or exceeded a limit.
            StoppedError: the work was cancelled.
        """
        out, err, into = (self.folder / name for name in ("out", "err", "in"))
        into.write_bytes(given)
        line = command((*_NETWORK, *_HARMLESS, *arguments), folder=within)
        surroundings = environment(protocols) | {"GIT_SSH_COMMAND": "ssh -o BatchMode=yes"}
        surroundings.pop("SSH_ASKPASS", None)
        with out.open("wb") as printed, err.open("wb") as errors, into.open("rb") as read:
            process = subprocess.Popen(  # noqa: S603  (fixed program; addresses follow `--`)
                line, stdin=read, stdout=printed, stderr=errors, env=surroundings, start_new_session=True
            )
            try:
                self._attend(process)
            finally:
                if process.poll() is None:
                    with suppress(ProcessLookupError, PermissionError):
                        os.killpg(process.pid, signal.SIGKILL)  # git and its children
                    process.wait()
        with err.open("rb") as errors:
            self.words = errors.read(_MOST_WORDS).decode("utf-8", "replace")
        if process.returncode:
            raise _failure(self.words, process.returncode)
        if out.stat().st_size > _MOST_OUTPUT:
            raise FetchingError("too large", "it has more files than can be listed")
        return out.read_bytes()

    def weigh(self) -> int:
        """Return the size of the folder in bytes; FetchingError above the limit."""
        size = folder_bytes(self.folder)
        if size > self._limits.bytes:
            raise self.large()
        return size

    def large(self) -> FetchingError:
        """Return the error for a repository above the size limit."""
        most = self._limits.bytes
        shown = f"{most / (1 << 20):,.0f} MB" if most >= 1 << 20 else f"{most:,} bytes"
        return FetchingError("too large", f"it is larger than {shown}")

    @property
    def room(self) -> int:
        """The size limit in bytes."""
        return self._limits.bytes

    def _late(self) -> FetchingError:
        return FetchingError("too slow", f"it did not arrive within {self._limits.seconds:g} s")

    def _attend(self, process: subprocess.Popen[bytes]) -> None:
        pause, next_weighing = _FIRST_PAUSE, 0.0
        while True:
            with suppress(subprocess.TimeoutExpired):
                process.wait(pause)
                return
            pause = min(pause * 2, _LONGEST_PAUSE)
            if self._stop.is_set():
                raise StoppedError
            now = time.monotonic()
            if now > self._deadline:
                raise self._late()
            if now >= next_weighing:
                self.weigh()
                next_weighing = time.monotonic() + (time.monotonic() - now) * _WEIGHING_SHARE


def folder_bytes(folder: Path) -> int:
    """Return the total size of all files below a folder; links are not followed."""
    size = 0
    pending = [str(folder)]
    while pending:
        with suppress(OSError), os.scandir(pending.pop()) as entries:
            for entry in entries:
                with suppress(OSError):
                    if entry.is_dir(follow_symlinks=False):
                        pending.append(entry.path)
                    else:
                        size += entry.stat(follow_symlinks=False).st_size
    return size


def _failure(words: str, code: int) -> FetchingError:
    lines = [re.sub(r"^(?:fatal|error|remote|ERROR): ", "", line.strip("\0 \t")) for line in words.splitlines()]
    telling = [line for line in lines if line and not line.startswith(_IDLE)]
    reason = without_password("; ".join(telling[:3])) or f"git ended with {code}"
    if "repository corruption" in words:
        return FetchingError("damaged", reason)
    if _REFUSED.search(words):
        return FetchingError("refused", reason)
    if _GONE.search(words):
        return FetchingError("gone", reason)
    if _PASSING.search(words):
        return FetchingError("unreachable", reason, passing=True)
    return FetchingError("failed", reason)
