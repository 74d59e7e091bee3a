"""State of the shell between runs: buffers of each store, history, and choices; readable by the owner only."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from kg.store.layout import write_atomically

_KEPT: Final = 2_000  # maximum number of entries in the history


def state_folder() -> Path:
    """Return the folder of the shell below `$XDG_STATE_HOME` or `~/.local/state`; it may not exist yet."""
    given = Path(os.environ.get("XDG_STATE_HOME", ""))
    return (given if given.is_absolute() else Path.home() / ".local" / "state") / "kg" / "shell"


@dataclass(frozen=True, slots=True)
class Entry:
    """An executed query: `when` is in seconds since 1970, `outcome` is `ok` or the code of an error."""

    text: str
    when: float
    store: str
    rows: int
    seconds: float
    outcome: str


class State:
    """Reads and writes the folder; unreadable files are ignored, and the first unwritable one is told to `tell`."""

    def __init__(self, folder: Path, store: str) -> None:
        self._folder = folder
        self._buffers = f"buffers-{hashlib.sha256(store.encode()).hexdigest()[:16]}.json"
        self._told = False
        self.tell: Callable[[str], object] = lambda _why: None

    def buffers(self) -> list[str]:
        """Return the saved buffers of this store."""
        saved = self._read(self._buffers, [])
        return [one for one in saved if isinstance(one, str)] if isinstance(saved, list) else []

    def keep_buffers(self, texts: Sequence[str]) -> None:
        """Save the texts of the buffers for this store."""
        self._write(self._buffers, list(texts))

    def choice(self, name: str, default: str) -> str:
        """Return a saved choice, such as the theme."""
        saved = self._read("choices.json", {})
        value = saved.get(name, default) if isinstance(saved, dict) else default
        return value if isinstance(value, str) else default

    def keep_choice(self, name: str, value: str) -> None:
        """Save a choice for all stores."""
        saved = self._read("choices.json", {})
        self._write("choices.json", {**(saved if isinstance(saved, dict) else {}), name: value})

    def history(self) -> list[Entry]:
        """Return the history of all stores, the newest first, without duplicates."""
        entries: dict[str, Entry] = {}
        for line in reversed(self._lines()):
            try:
                entry = Entry(**json.loads(line))
            except (ValueError, TypeError):
                continue
            entries.setdefault(entry.text, entry)
        return list(entries.values())

    def remember(self, entry: Entry) -> None:
        """Add an entry to the history; other shells may do the same concurrently."""
        lines = self._lines()
        if len(lines) >= _KEPT * 2:
            self._guarded(lambda: _write(self._folder / "history.jsonl", "\n".join(lines[-_KEPT:]) + "\n"))
        self._guarded(lambda: _append(self._ensure_folder() / "history.jsonl", json.dumps(asdict(entry)) + "\n"))

    def keep_failure(self, words: str) -> Path:
        """Save the traceback of the last unexpected error; return its file."""
        self._guarded(lambda: _write(self._ensure_folder() / "failure.txt", words))
        return self._folder / "failure.txt"

    def _lines(self) -> list[str]:
        try:
            return (self._folder / "history.jsonl").read_text("utf-8", errors="replace").splitlines()
        except OSError:
            return []

    def _read(self, name: str, default: Any) -> Any:
        try:
            return json.loads((self._folder / name).read_bytes())
        except (OSError, ValueError):
            return default

    def _write(self, name: str, content: Any) -> None:
        self._guarded(lambda: _write(self._ensure_folder() / name, json.dumps(content, ensure_ascii=False)))

    def _ensure_folder(self) -> Path:
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        return self._folder

    def _guarded(self, write: Any) -> None:
        try:
            write()
        except OSError as error:
            if not self._told:
                self._told = True
                self.tell(f"{self._folder}: {error.strerror or error}")


def _write(path: Path, text: str) -> None:
    previous = os.umask(0o077)
    try:
        write_atomically(path, text.encode("utf-8", errors="surrogatepass"), durable=False)
    finally:
        os.umask(previous)


def _append(path: Path, line: str) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    with os.fdopen(descriptor, "w", encoding="utf-8") as file:
        file.write(line)
