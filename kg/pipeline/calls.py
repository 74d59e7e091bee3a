"""User descriptions of framework calls: the files `*.toml` of the setting `calls`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from kg.errors import Place, SourceError
from kg.lazily import lazily
from kg.settings import Settings, user_paths

with lazily():
    from kg.symbolic.checking import check


def call_files(settings: Settings) -> list[Path]:
    """Return the files of descriptions of the settings, in order of precedence.

    Raises UsageError KG002 for a path of the setting that does not exist.
    """
    paths = user_paths(settings, "calls")
    return [file for path in paths for file in (sorted(path.glob("*.toml")) if path.is_dir() else [path])]


def read_calls(files: Iterable[Path]) -> dict[str, str]:
    """Return the texts of files of descriptions by path; SourceError KG110 for one that cannot be read."""
    texts = {}
    for file in files:
        try:
            texts[str(file)] = Path(file).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as problem:
            hint = "Name a file of TOML in UTF-8, or remove it from the setting `calls`."
            raise SourceError(
                "KG110", f"the file cannot be read: {problem}", place=Place(str(file)), hint=hint
            ) from None
    return texts


def checked_calls(settings: Settings) -> tuple[str, ...]:
    """Return the checked texts of the descriptions of the settings.

    Raises:
        SourceError: KG110 for a file that cannot be read, KG123 and KG124 for the first error in a file.
        UsageError: KG002 for a path of the setting that does not exist.
    """
    texts = read_calls(call_files(settings))
    if not texts:
        return ()

    for error in check(texts):
        raise SourceError(
            error.code, error.message, place=error.place, hint=f"{error.hint} `kg extract check` lists all errors."
        )
    return tuple(texts.values())
