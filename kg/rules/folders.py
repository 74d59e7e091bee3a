"""The rules of users: the settings `rules` and `rule_families`, checked against the files.

By default rules are in `rules/` next to kg.toml or in the working folder.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

from kg.errors import UsageError
from kg.resources import folder as shipped
from kg.rules.files import family_of
from kg.rules.reading import packs, rule_files
from kg.settings import Settings, user_paths
from kg.settings import own_folder as default_folder
from kg.similar import did_you_mean

_NAME: Final = "rules"


def user_folders(settings: Settings) -> tuple[Path, ...]:
    """Return the folders of rules in force in addition to those that `kg` ships; the default one only if it exists.

    Raises UsageError KG002 for a folder of the setting `rules` that does not exist.
    """
    named = user_paths(settings, _NAME)
    own = shipped(_NAME).resolve()
    return tuple(folder for folder in named if folder.resolve() != own)


def own_folder(settings: Settings) -> Path:
    """Return the folder that new rules are written to, whether it exists or not."""
    return settings.rules[0] if settings.rules else default_folder(_NAME)


def families_in_force(settings: Settings) -> tuple[str, ...]:
    """Return the families that the setting `rule_families` names, as `kg.rules.reading.rule_files` takes them.

    Raises UsageError KG002 for one without rules, with suggestions.
    """
    if not settings.rule_families:
        return ()
    families = all_families(settings)
    for name in settings.rule_families:
        plain = name.removeprefix("+")
        if plain not in families:
            origin = settings.origin("rule_families")
            message = f"{origin.name or 'the setting `rule_families`'} names an unknown family of rules, `{plain}`"
            hint = did_you_mean(plain, families) or f"The families are {', '.join(families)}."
            raise UsageError("KG002", message, place=origin.place, hint=hint)
    return settings.rule_families


def all_families(settings: Settings) -> list[str]:
    """Return the names of all families, those not in force too, sorted."""
    folders = (shipped(_NAME), *(pack.folder for pack in packs()), *user_folders(settings))
    return sorted({family_of(name) for folder in folders for _, name in rule_files(folder, every=True)} - {""})
