"""What would break if a name of a system were renamed, removed or changed, with the lines to look at."""

from __future__ import annotations

from kg.impact.model import (
    CHANNELS,
    Area,
    DefinitionRecord,
    Effect,
    FileRecord,
    Grade,
    Impact,
    Kind,
    PackageRecord,
    Subject,
    World,
)

__all__ = [
    "CHANNELS",
    "Area",
    "DefinitionRecord",
    "Effect",
    "FileRecord",
    "Grade",
    "Impact",
    "Kind",
    "PackageRecord",
    "Subject",
    "World",
]
