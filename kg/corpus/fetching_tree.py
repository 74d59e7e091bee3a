"""What stands in a commit and in a checkout: how large it gets, links that lead out, versions of ROS."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

_ROS1: Final = re.compile(
    rb"<build_type[^>]*>\s*catkin|<(?:buildtool_depend|buildtool_export_depend)[^>]*>\s*catkin\s*<"
)
_ROS2: Final = re.compile(
    rb"<build_type[^>]*>\s*ament_|<buildtool_depend[^>]*>\s*ament_|<depend[^>]*>\s*rcl(?:cpp|py)\s*<"
)
_MANIFESTS: Final = {"package.xml": None, "manifest.xml": "1", "stack.xml": "1"}
"""Names of manifests, and the version that the name alone says."""
_MOST_BYTES: Final = 1 << 16
_ENTRY: Final = re.compile(rb"\d+ (?P<kind>\w+) [0-9a-f]+ +(?P<size>-|\d+)\t")


def content_bytes(listing: bytes) -> int:
    """Return the sizes of all files in what `git ls-tree -r -l -z` prints, added up."""
    sizes = (match["size"] for line in listing.split(b"\0") if (match := _ENTRY.match(line)))
    return sum(int(size) for size in sizes if size != b"-")


def outward_links(top: Path) -> tuple[str, ...]:
    """Return the links in a checkout that lead out of it or into its `.git`, relative to it.

    A link with an absolute path always does: the checkout may be moved.
    """
    real = os.path.realpath(top)
    found = []
    for entry in _entries(top):
        if entry.is_symlink():
            target = os.path.realpath(entry.path)
            inside = target == real or target.startswith(real + os.sep)
            hidden = target.startswith(os.path.join(real, ".git") + os.sep) or target == os.path.join(real, ".git")  # noqa: PTH118 - texts, as scandir gives them
            if not inside or hidden or os.path.isabs(os.readlink(entry.path)):  # noqa: PTH117, PTH115 - the same
                found.append(os.path.relpath(entry.path, top))
    return tuple(sorted(found))


def ros_versions(top: Path) -> str:
    """Return the versions of ROS that the manifests in a checkout are for: `1`, `2`, `1 2`, or nothing."""
    found: set[str] = set()
    for entry in _entries(top):
        if entry.name in _MANIFESTS and entry.is_file(follow_symlinks=False):
            found |= _versions(Path(entry.path))
            if len(found) == 2:  # noqa: PLR2004 - there are two versions
                break
    return " ".join(sorted(found))


def _versions(manifest: Path) -> set[str]:
    named = _MANIFESTS[manifest.name]
    if named:
        return {named}
    try:
        with manifest.open("rb") as stream:
            text = stream.read(_MOST_BYTES)
    except OSError:
        return set()
    return {version for version, pattern in (("1", _ROS1), ("2", _ROS2)) if pattern.search(text)}


def _entries(top: Path) -> Iterator[os.DirEntry[str]]:
    """Yield every file, link and folder below `top` but `.git`; links are not followed."""
    pending = [str(top)]
    while pending:
        with os.scandir(pending.pop()) as entries:
            for entry in entries:
                if entry.name == ".git":
                    continue
                yield entry
                if entry.is_dir(follow_symlinks=False):
                    pending.append(entry.path)
