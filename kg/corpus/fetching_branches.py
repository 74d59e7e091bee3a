"""Which branch of a repository is for ROS 1 or for ROS 2, by the names of its branches.

A branch is marked by its name: `ros2`, `ros1-legacy`, `noetic-devel`, `humble`. Marks are certain, `main` and `master`
say nothing: they were ROS 1 once and are ROS 2 in many repositories today. The order in which branches are tried is

* for `any`: the default branch, and no other;
* for one version: the default branch if it is marked so; where any branch is marked for the other version, or none is
  the default one, the branches marked for this one, the newest distribution first; the default branch if it is
  not marked at all; `main`, `master`, `devel` and the like; last, marked branches that were passed over.

What the manifests in a branch say decides in the end (`kg.corpus.fetching_one`): a branch that turns out to be for the
other version is given up for the next one.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable

VERSIONS: Final = ("1", "2", "any")

# Newest first: https://wiki.ros.org/Distributions and https://docs.ros.org/en/rolling/Releases.html.
_DISTRIBUTIONS: Final = {
    "1": "noetic melodic lunar kinetic jade indigo hydro groovy fuerte electric diamondback cturtle boxturtle",
    "2": "rolling lyrical kilted jazzy iron humble galactic foxy eloquent dashing crystal bouncy ardent",
}
_RANK: Final = {
    name: (version, rank) for version, names in _DISTRIBUTIONS.items() for rank, name in enumerate(names.split())
}
_PLAIN: Final = ("main", "master", "devel", "develop", "development", "dev")
_BESIDE: Final = frozenset({*_PLAIN, "ros", "branch", "stable", "legacy", "release", "catkin"})
"""Words that may stand beside a mark; a branch with any other (`fix-noetic-build`) is somebody's work."""


def branches_to_try(default: str | None, branches: Iterable[str], version: str) -> tuple[str, ...]:
    """Return the branches to try for a version of ROS (`VERSIONS`), best first; empty when none can be for it.

    `default` is the branch that the server names as its own, None where it names none.
    """
    names = sorted(set(branches))
    if version == "any":
        plain = [name for name in _PLAIN if name in names]
        return (default,) if default else tuple(plain[:1] or names[:1])
    other = "2" if version == "1" else "1"
    own = marked(default, free=True) if default else None
    found = {name: mark for name in names if (mark := _mark(name)) and mark[0] == version}
    ours = sorted(found, key=lambda name: (found[name], name))
    both = default is None or own == other or any(marked(name) == other for name in names)
    order = [
        *([default] if default and own == version else []),
        *(ours if both else []),
        *([default] if default and own is None else []),
        *([name for name in _PLAIN if name in names] if own != version else []),
        *ours,
    ]
    return tuple(dict.fromkeys(order))


def marked(branch: str, *, free: bool = False) -> str | None:
    """Return the version of ROS that the name of a branch says, None where it says none or both.

    Names with words that are no usual part of such a name say nothing, unless `free`: the default branch may be
    called what it likes.
    """
    found = _mark(branch, free=free)
    return found[0] if found else None


def _mark(branch: str, *, free: bool = False) -> tuple[str, int] | None:
    """Return the version and how far down its distribution stands; `ros1` and `ros2` stand before all."""
    words = [word for word in re.split(r"[^a-z0-9]+", branch.lower()) if word and not word.isdigit()]
    marks: dict[str, int] = {}
    for word in words:
        if word in {"ros1", "ros2"}:
            marks.setdefault(word[-1], -1)
        elif word in _RANK:
            version, rank = _RANK[word]
            marks[version] = rank
        elif word not in _BESIDE and not free:
            return None
    return next(iter(marks.items())) if len(marks) == 1 else None
