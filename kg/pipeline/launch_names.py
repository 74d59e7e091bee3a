"""Find launch configurations by the names that users type, and parse their arguments."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from kg.errors import Place, UnknownNameError, UsageError, choices
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.graph.reading.systems import SystemName


def find(names: Sequence[SystemName], text: str, roots: Mapping[str, str]) -> SystemName:
    """Return the one of `names` that `text` refers to: the path of a file on disk, or a name as in `matching`.

    `roots` contains the folder of each source.

    Raises:
        UnknownNameError: KG422 if none matches.
        UsageError: KG003 if several match.
    """
    matches = _on_disk(names, Path(text), roots) or matching(names, text)
    if not matches:
        raise unknown_launch(names, text)
    if len(matches) > 1:
        raise several_launches(names, matches, text, option="--launch ")
    return matches[0]


def several_launches(
    names: Sequence[SystemName], matches: Sequence[SystemName], text: str, option: str = ""
) -> UsageError:
    """Return the error KG003: `text` matches all of `matches`; the hint lists an unambiguous text for each."""
    ways = choices([f"`{option}{_shortest(names, one)}`  ({one.repository}:{one.path})" for one in matches])
    return UsageError("KG003", f"{len(matches)} launch files are called `{text}`; choose one", hint=ways)


def shared_names(names: Sequence[SystemName]) -> dict[SystemName, str]:
    """Return an unambiguous text for each launch file whose name is shared by others."""
    count = Counter(one.name for one in names)
    return {one: _shortest(names, one) for one in names if count[one.name] > 1}


def _shortest(names: Sequence[SystemName], one: SystemName) -> str:
    """Return the name of a launch file if it is unique, else its path, else that with its source."""
    whole = f"{one.repository}:{one.path}"
    return next((text for text in (one.name, one.path) if matching(names, text) == [one]), whole)


def matching(names: Sequence[SystemName], text: str) -> list[SystemName]:
    """Return those of `names` that match `text` in the first of these ways that has matches.

    It is `source:path`, a name (`package/launch/x.launch`) or a path in a source, the end of one of the two in whole
    segments, or `package x.launch` as for roslaunch.
    """
    words = text.split()
    wanted = "/".join(words)
    return (
        [one for one in names if text == f"{one.repository}:{one.path}"]
        or [one for one in names if wanted in {one.name, one.path}]
        or [one for one in names if f"/{one.name}".endswith(f"/{wanted}") or f"/{one.path}".endswith(f"/{wanted}")]
        or [one for one in names if _package_and_file(one, words)]
    )


def unknown_launch(names: Sequence[SystemName], text: str) -> UnknownNameError:
    """Return the error KG422: `text` matches none of `names`, with suggestions."""
    every = [one.name for one in names] + [one.name.rpartition("/")[2] for one in names]
    hint = did_you_mean("/".join(text.split()), every)
    place = Place(text) if Path(text).exists() else None
    message = f"the store has no launch file `{text}`"
    otherwise = "`kg instances` lists the launch files of the store; `kg node NAME` lists those that start a node."
    return UnknownNameError("KG422", message, place=place, hint=hint or otherwise)


def assignments(texts: Sequence[str], sign: str = ":=") -> dict[str, str]:
    """Return `x:=y` as names and values; UsageError KG003 for a text with another separator, or none."""
    values = {}
    for text in texts:
        name, mark, value = text.partition(sign)
        if not mark or not name.strip() or name.endswith(":"):
            given, _, given_value = text.replace(":=", "=", 1).partition("=")
            hint = f"Write `{given.strip()}{sign}{given_value}`." if given.strip() and "=" in text else None
            raise UsageError("KG003", f"`{text}` is not written as NAME{sign}VALUE", hint=hint)
        values[name.strip()] = value
    return values


def check_given(launch: str | None, arguments: Mapping[str, str], environment: Mapping[str, str]) -> None:
    """Raise UsageError KG003 if arguments or environment variables are given without a launch file."""
    if launch is None and (arguments or environment):
        raise UsageError("KG003", "arguments are for one launch file", hint="Name it with `--launch FILE`.")


def _on_disk(names: Sequence[SystemName], path: Path, roots: Mapping[str, str]) -> list[SystemName]:
    if not path.is_file():
        return []
    real = path.resolve()
    return [
        one for one in names if one.repository in roots and (Path(roots[one.repository]) / one.path).resolve() == real
    ]


def _package_and_file(name: SystemName, words: Sequence[str]) -> bool:
    package, _, inner = name.name.partition("/")
    return len(words) == 2 and words[0] == package and f"/{inner}".endswith(f"/{words[1]}")  # noqa: PLR2004 - as above
