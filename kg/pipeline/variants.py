"""Variants of launch files: each boolean argument inverted, and environment variables that enable branches.

One argument or variable changes at a time: nodes that require two changes are not found.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.graph.reading.systems import system_names
from kg.pipeline.launch_names import check_given, find
from kg.pipeline.launching import LaunchFile
from kg.pipeline.state import load

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.facts import InstanceInterface, NodeInstance, System
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore

MOST_VARIANTS: Final = 32
"""Largest number of evaluated variants of a launch file."""
_OTHER: Final = {"true": "false", "false": "true", "True": "False", "False": "True"}
_VARIABLE: Final = re.compile(
    r"""(?x)
    optenv \s* \(? \s* ['"]? (?P<optenv>\w+) ['"]? \s*,?\s* (?:['"]? (?P<optenv_default>\w+))?
    | \$\(env \s+ (?P<env>\w+) \s+ (?P<env_default>\w+) \s* \)
    | EnvironmentVariable\( \s* (?:name\s*=\s*)? ['"](?P<of>\w+)['"] \s*,\s* (?:default_value\s*=\s*)?
      ['"](?P<of_default>\w*)['"]
    | (?:os\.environ\.get|os\.getenv|environ\.get|getenv)\( \s* ['"](?P<got>\w+)['"]
      (?: \s*,\s* ['"](?P<got_default>\w*)['"] )?
    | ['"](?P<tested>\w+)['"] \s+ in \s+ (?:os\.)?environ
    """
)
"""An environment variable in a launch file, with its default."""
_SET: Final = "1"


@dataclass(frozen=True, slots=True)
class Variants:
    """The system of a launch file, and those of its variants by their difference (`use_rviz:=True`, `CAMERA=1`).

    `left_out` contains variants that were not evaluated, because there are too many.
    """

    system: System
    others: tuple[tuple[str, System], ...]
    left_out: tuple[str, ...] = ()


def variants(
    settings: Settings,
    store: EmbeddedStore,
    launch: str,
    arguments: Mapping[str, str],
    environment: Mapping[str, str],
) -> Variants:
    """Return the systems of a launch file with the given arguments and variables, and with each other one changed.

    Raises as `kg.pipeline.launching.chosen`.
    """
    check_given(launch, arguments, environment)
    state = load(store.layout.cache)
    roots = {name: source.repository.root for name, source in state.sources.items()}
    with store.read() as snapshot:
        file = LaunchFile(settings, snapshot, state, find(system_names(snapshot), launch, roots))
        system = file.system(arguments, environment)
        changed: list[tuple[str, dict[str, str], dict[str, str]]] = [
            *((f"{name}:={value}", {name: value}, {}) for name, value in _flipped(system, arguments)),
            *((f"{name}={value}", {}, {name: value}) for name, value in _unset(system, file, environment).items()),
        ]
        others = tuple(
            (label, file.system({**arguments, **given}, {**environment, **variable}))
            for label, given, variable in changed[:MOST_VARIANTS]
        )
    return Variants(system, others, tuple(label for label, _, _ in changed[MOST_VARIANTS:]))


def _flipped(system: System, given: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield the boolean arguments that are not given, each with its opposite value."""
    for one in system.configuration.arguments:
        other = _OTHER.get(one.default or "" if one.value is None else one.value)
        if one.name not in given and not one.fixed and other is not None:
            yield one.name, next((c for c in one.choices if c.lower() == other.lower()), other)


def _unset(system: System, file: LaunchFile, given: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that the files of a system read and that are not given, with another value."""
    values: dict[str, str] = {}
    for place in sorted(system.configuration.files):
        text = (file.reader.read(FilePath(*place)) or b"").decode("utf-8", "replace")
        for match in _VARIABLE.finditer(text):
            groups = {key.partition("_")[0] for key, value in match.groupdict().items() if value is not None}
            for key in groups:
                name, default = match[key], match.groupdict().get(f"{key}_default")
                value = {**_OTHER, "0": "1", "1": "0"}.get(default) if default else _SET
                if name not in given and value is not None:
                    values.setdefault(name, value)
    return values


def united(evaluated: Variants) -> System:
    """Return the system with the additions of its variants: each such node and end has its variants as condition."""
    instances = {_key(one): one for one in evaluated.system.instances}
    labels: dict[object, list[str]] = {}
    for label, system in evaluated.others:
        for one in system.instances:
            if _key(one) not in instances:
                instances[_key(one)] = one
                labels[_key(one)] = []
            if _key(one) in labels:
                labels[_key(one)].append(label)
    ends = {key: {_end(end): end for end in one.interfaces} for key, one in instances.items()}
    for label, system in evaluated.others:
        for one in system.instances:
            for end in one.interfaces if _key(one) not in labels else ():
                if _end(end) not in ends[_key(one)]:
                    ends[_key(one)][_end(end)] = end
                    labels[_key(one), _end(end)] = []
                if (_key(one), _end(end)) in labels:
                    labels[_key(one), _end(end)].append(label)
    return replace(
        evaluated.system,
        instances=tuple(_marked(one, ends[key].values(), labels, key) for key, one in instances.items()),
    )


def _marked(
    one: NodeInstance, ends: Iterable[InstanceInterface], labels: Mapping[object, list[str]], key: object
) -> NodeInstance:
    """Return an instance whose conditions, and those of its ends, are the variants that contain them."""
    started = one.started
    if key in labels:
        started = replace(started, condition=" and ".join(filter(None, (started.condition, _only(labels[key])))))
    marked = (
        replace(end, reason=f"only with {_only(labels[key, _end(end)])}") if (key, _end(end)) in labels else end
        for end in ends
    )
    return replace(one, started=started, interfaces=tuple(marked))


def _only(labels: list[str]) -> str:
    return " or ".join(labels)


def _key(one: NodeInstance) -> tuple[str, str]:
    return one.name, one.started_type


def _end(end: InstanceInterface) -> tuple[object, ...]:
    return end.declared.role, end.resolved, end.declared.type, end.declared.name if end.resolved is None else None
