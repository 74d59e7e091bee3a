"""The branch of a repository for ROS 1 or ROS 2, by the names of its branches.

A name may mark the version: `ros2`, `ros1-legacy`, `noetic-devel`, `humble`. Marks are reliable; `main` and `master`
are not, since many repositories moved from ROS 1 to ROS 2 on them. Branches are tried in this order:

* for `any`: only the default branch;
* for one version: the default branch if it is marked so; if any branch is marked for the other version, or there is no
  default, the branches marked for this one, the newest distribution first; an unmarked default branch; `main`,
  `master`, `devel` and the like; finally, marked branches that were skipped.

The manifests in a branch decide in the end (`kg.corpus.fetching.one`): a branch for the other version is rejected for
the next one.
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
"""Words allowed next to a mark; a branch with any other (`fix-noetic-build`) is a topic branch."""


def branches_to_try(default: str | None, branches: Iterable[str], version: str) -> tuple[str, ...]:
    """Return the branches to try for a version of ROS (`VERSIONS`), best first; empty if none is suitable.

    `default` is the server's default branch, None without one.
    """
    names = sorted(set(branches))
    if version == "any":
        plain = [name for name in _PLAIN if name in names]
        return (default,) if default else tuple(plain[:1] or names[:1])
    other = "2" if version == "1" else "1"
    own = marked(default, free=True) if default else None
    marks = {name: mark for name in names if (mark := _mark(name)) and mark[0] == version}
    ours = sorted(marks, key=lambda name: (marks[name], name))
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
    """Return the version of ROS in the name of a branch, None if it has none or both.

    Names with unusual words are ignored, unless `free`: the default branch may have any name.
    """
    mark = _mark(branch, free=free)
    return mark[0] if mark else None


def _mark(branch: str, *, free: bool = False) -> tuple[str, int] | None:
    """Return the version, and the rank of its distribution; `ros1` and `ros2` rank first."""
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
