"""The folders of rules that users keep: the setting `rules`, else `rules/` beside kg.toml or the working folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.resources import folder as shipped
from kg.settings import find_file

if TYPE_CHECKING:
    from kg.settings import Settings

__all__ = ["own_folder", "user_folders"]

_NAME: Final = "rules"


def user_folders(settings: Settings) -> tuple[Path, ...]:
    """Return the folders of rules in force beside those that `kg` ships; the default one only where it exists."""
    default = _default()
    named = settings.rules or ((default,) if default.is_dir() else ())
    own = shipped(_NAME).resolve()
    return tuple(folder for folder in named if folder.resolve() != own)


def own_folder(settings: Settings) -> Path:
    """Return the folder that new rules are written to, whether it exists or not."""
    return settings.rules[0] if settings.rules else _default()


def _default() -> Path:
    here = Path.cwd()
    file = find_file(here)
    return Path(_NAME) if file is None or file.parent == here else file.parent / _NAME
