"""What the command line of a ROS 2 process says of its node: `--ros-args -r a:=b -p x:=y --params-file f`.

Source: `rcl_parse_arguments` and the design article "ROS Command Line Arguments".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["CommandLine", "parse_command_line"]

_REMAP: Final = {"-r", "--remap"}
_PARAMETER: Final = {"-p", "--param"}
_FILE: Final = {"--params-file", "--param-file"}
_WITH_OPERAND: Final = {"--log-level", "--log-config-file", "--log-file-name", "-e", "--enclave"}


@dataclass(slots=True)
class CommandLine:
    """The parts of a command line; `rest` are the arguments that are not for ROS."""

    remaps: list[tuple[str, str]] = field(default_factory=list)
    parameters: list[tuple[str, str | None]] = field(default_factory=list)
    """Names and values as YAML, or the path of a file and None, in order."""
    name: str | None = None
    namespace: str | None = None
    rest: list[str] = field(default_factory=list)


def parse_command_line(words: Sequence[str]) -> CommandLine:
    """Return what `words` say; rules outside of `--ros-args` count as well, as they did before ROS 2 Eloquent."""
    line = CommandLine()
    inside = False
    remaining = iter(words)
    for word in remaining:
        if word == "--ros-args":
            inside = True
        elif inside and word == "--":
            inside = False
        elif inside:
            _option(line, word, remaining)
        elif ":=" in word:
            _rule(line, word)
        else:
            line.rest.append(word)
    return line


def _option(line: CommandLine, word: str, remaining: Iterator[str]) -> None:
    if word in _REMAP:
        _rule(line, next(remaining, ""))
    elif word in _PARAMETER:
        name, colon, value = next(remaining, "").partition(":=")
        if colon:
            line.parameters.append((name, value))
    elif word in _FILE:
        line.parameters.append((next(remaining, ""), None))
    elif word in _WITH_OPERAND:
        next(remaining, None)
    elif ":=" in word:
        _rule(line, word)


def _rule(line: CommandLine, rule: str) -> None:
    """Take a rule of remapping; of several for one thing the first counts."""
    source, colon, target = rule.partition(":=")
    if not colon:
        return
    if source in ("__node", "__name"):
        line.name = line.name or target
    elif source == "__ns":
        line.namespace = line.namespace or target
    else:
        line.remaps.append((source, target))
