"""The impact of a change to one subject."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.impact.channels import channel_about, channel_effects
from kg.impact.files import declared_subjects, file_about, file_effects, file_mentions
from kg.impact.launches import argument_about, argument_effects
from kg.impact.model import CHANNELS, Effect, Impact, Kind, Subject, World, merged
from kg.impact.nodes import node_about, node_effects
from kg.impact.parameters import declared_settings, parameter_about, parameter_effects
from kg.impact.texts import HOLDING, absolute_name, mentions
from kg.impact.types import field_mentions, type_about, type_effects, type_mentions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator


_EFFECTS: Final[dict[Kind, Callable[[Subject, World], Iterator[Effect]]]] = {
    **dict.fromkeys(CHANNELS, channel_effects),
    Kind.TYPE: type_effects,
    Kind.FIELD: type_effects,
    Kind.PARAMETER: parameter_effects,
    Kind.NODE: node_effects,
    Kind.ARGUMENT: argument_effects,
    Kind.FILE: file_effects,
}
_ABOUT: Final[dict[Kind, Callable[[Subject, World], list[str]]]] = {
    **dict.fromkeys(CHANNELS, channel_about),
    Kind.TYPE: type_about,
    Kind.FIELD: type_about,
    Kind.PARAMETER: parameter_about,
    Kind.NODE: node_about,
    Kind.ARGUMENT: argument_about,
    Kind.FILE: file_about,
}


def impact(subject: Subject, world: World) -> Impact:
    """Return what breaks or may break if a subject is renamed, removed or changed.

    A line that no fact covers, but whose text names the subject, is among the effects that may break.
    """
    subjects = [subject, *(declared_subjects(subject, world) if subject.kind is Kind.FILE else ())]
    stated = merged(effect for one in subjects for effect in _EFFECTS[one.kind](one, world))
    covered = {(one.repository, one.location) for one in stated}
    if subject.kind is Kind.PARAMETER:
        covered |= set(declared_settings(subject, world))
    texts = (effect for one in subjects for effect in _mentions(one, world))
    effects = merged([*stated, *(one for one in texts if (one.repository, one.location) not in covered)])
    return Impact(subject, tuple(_ABOUT[subject.kind](subject, world)), effects)


def _mentions(subject: Subject, world: World) -> Iterable[Effect]:
    if subject.kind in CHANNELS:
        files = (file for file in world.files if file.kind in HOLDING)
        pattern = absolute_name(subject.name)
        return mentions(world, files, [subject.name], pattern, f"holds the name of the {subject.kind}")
    if subject.kind is Kind.TYPE:
        return type_mentions(subject, world)
    if subject.kind is Kind.FIELD:
        return field_mentions(subject, world)
    if subject.kind is Kind.PARAMETER:
        name = subject.name.rpartition(".")[2].removeprefix("~/")
        key = re.compile(rf"^\s*(?:\S*[./])?{re.escape(name)}\s*:(?!=)")
        files = (file for file in world.files if file.kind in HOLDING)
        return mentions(world, files, [name], key, "a key of this name; whether it is for this node is not known")
    if subject.kind is Kind.FILE:
        return file_mentions(subject, world)
    return ()
