"""Fetching of one repository: into a temporary folder, then into its place by one rename.

Nothing in it is run: no hooks, no filters, no Git LFS. Git validates objects before storing them
(`transfer.fsckObjects`), which refuses trees with `..` or `.git`, and submodules with addresses that are options. The
sizes of the files are checked before they are written. Links that lead out of the checkout are removed.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.corpus.fetching.git import FetchingError, Limits, Watch, folder_bytes
from kg.corpus.fetching.lock import FETCHED, Entry
from kg.corpus.fetching.wanted import Wanted, protocols
from kg.corpus.git import run_git, without_password

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from threading import Event

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

    `default` is the server's default branch, None without one. A name may mark the version: `ros2`, `ros1-legacy`,
    `noetic-devel`, `humble`. Marks are reliable; `main` and `master` are not, since many repositories moved from ROS 1
    to ROS 2 on them. The order:

    * for `any`: only the default branch;
    * for one version: the default branch if it is marked so; if any branch is marked for the other version, or there
      is no default, the branches marked for this one, the newest distribution first; an unmarked default branch;
      `main`, `master`, `devel` and the like; finally, marked branches that were skipped.

    The manifests in a branch decide in the end: a branch for the other version is rejected for the next one.
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


_MOST_TRIED: Final = 3
_MOVED: Final = re.compile(r"^warning: redirecting to (\S+)$", re.MULTILINE)
_BRANCH: Final = re.compile(r"(?P<commit>[0-9a-f]{40,64})\trefs/heads/(?P<name>[^\s\x00-\x20\x7f]+)")
_DEFAULT: Final = re.compile(r"ref: refs/heads/(?P<name>\S+)\tHEAD")

_ROS1: Final = re.compile(
    rb"<build_type[^>]*>\s*catkin|<(?:buildtool_depend|buildtool_export_depend)[^>]*>\s*catkin\s*<"
)
_ROS2: Final = re.compile(
    rb"<build_type[^>]*>\s*ament_|<buildtool_depend[^>]*>\s*ament_|<depend[^>]*>\s*rcl(?:cpp|py)\s*<"
)
_MANIFESTS: Final = {"package.xml": None, "manifest.xml": "1", "stack.xml": "1"}
"""Names of manifests, and the version that the name implies."""
_MOST_BYTES: Final = 1 << 16
_ENTRY: Final = re.compile(rb"\d+ (?P<kind>\w+) [0-9a-f]+ +(?P<size>-|\d+)\t")


def content_bytes(listing: bytes) -> int:
    """Return the total size of all files in the output of `git ls-tree -r -l -z`."""
    sizes = (match["size"] for line in listing.split(b"\0") if (match := _ENTRY.match(line)))
    return sum(int(size) for size in sizes if size != b"-")


def outward_links(top: Path) -> tuple[str, ...]:
    """Return the links in a checkout that lead out of it or into its `.git`, relative to it.

    Absolute links always do: the checkout may be moved.
    """
    real = os.path.realpath(top)
    links = []
    for entry in _entries(top):
        if entry.is_symlink():
            target = os.path.realpath(entry.path)
            inside = target == real or target.startswith(real + os.sep)
            hidden = target.startswith(os.path.join(real, ".git") + os.sep) or target == os.path.join(real, ".git")  # noqa: PTH118 - texts, as scandir gives them
            if not inside or hidden or os.path.isabs(os.readlink(entry.path)):  # noqa: PTH117, PTH115 - the same
                links.append(os.path.relpath(entry.path, top))
    return tuple(sorted(links))


def ros_versions(top: Path) -> str:
    """Return the versions of ROS of the manifests in a checkout: `1`, `2`, `1 2`, or empty."""
    versions: set[str] = set()
    for entry in _entries(top):
        if entry.name in _MANIFESTS and entry.is_file(follow_symlinks=False):
            versions |= _versions(Path(entry.path))
            if len(versions) == 2:  # noqa: PLR2004 - there are two versions
                break
    return " ".join(sorted(versions))


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
    """Yield every file, link and folder below `top` except `.git`; links are not followed."""
    pending = [str(top)]
    while pending:
        with os.scandir(pending.pop()) as entries:
            for entry in entries:
                if entry.name == ".git":
                    continue
                yield entry
                if entry.is_dir(follow_symlinks=False):
                    pending.append(entry.path)


@dataclass(frozen=True, slots=True)
class Options:
    """Options of fetching: the version of ROS, submodules, and the limits of each repository.

    `jobs` run in parallel; with `update`, pinned commits are replaced by current ones.
    """

    ros: str = "any"
    jobs: int = 4
    submodules: bool = False
    update: bool = False
    limits: Limits = field(default_factory=Limits)


def is_at_commit(folder: Path, commit: str) -> bool:
    """Return whether a checkout is at a commit, judging by its `.git` only."""
    try:
        return bool(commit) and (folder / ".git" / "HEAD").read_text("ascii", "replace").strip() == commit
    except OSError:
        return False


def fetch_one(one: Wanted, pin: Entry | None, place: Path, workspace: Path, options: Options, stop: Event) -> Entry:  # noqa: PLR0913, PLR0917 - what one repository needs
    """Fetch a repository to the folder `place`, using the empty folder `workspace`, and return its entry.

    A `pin` determines the commit. Nothing is done if the checkout is already there. Temporary failures are retried. A
    failed repository has an entry with another state, and keeps its pin.

    Raises StoppedError: `stop` was set; `place` is unchanged.
    """
    entry = pin or Entry(one.name, one.url)
    if one.problem:
        return replace(entry, state="refused", reason=one.problem)
    if pin and is_at_commit(place, pin.commit):
        return replace(pin, state=FETCHED, reason=pin.reason if pin.state == FETCHED else "")
    fetching = _Fetching(one, place, workspace, options, stop)
    attempt = 0
    while True:
        try:
            return fetching.run(pin.commit if pin else "", entry)
        except FetchingError as error:
            if not error.passing or attempt >= options.limits.retries:
                return replace(entry, state=error.state, reason=error.reason)
            failed = error
        try:
            fetching.watch.wait(options.limits.pause * 2**attempt)
        except FetchingError:
            return replace(entry, state=failed.state, reason=failed.reason)
        attempt += 1


class _Fetching:
    """A repository being fetched."""

    def __init__(self, one: Wanted, place: Path, workspace: Path, options: Options, stop: Event) -> None:
        self.watch = Watch(workspace, options.limits, stop)
        self._one = one
        self._place = place
        self._tree = workspace / "tree"
        self._options = options
        self._protocols = protocols(one.url)
        self._moved = ""
        self._bytes = 0

    def run(self, commit: str, entry: Entry) -> Entry:
        """Fetch once: the commit, the requested ref, or the candidate branches for the version of ROS."""
        self._check_place()
        if commit:
            return self._finish(entry, entry.branch, self._fetch(commit, commit))
        if self._one.ref:
            commit_fetched = self._fetch(self._one.ref)
            return self._finish(entry, "" if commit_fetched == self._one.ref else self._one.ref, commit_fetched)
        default, branches = self._remote()
        names = branches_to_try(default, branches, self._options.ros)[:_MOST_TRIED]
        for name in names:
            if is_at_commit(self._place, branches.get(name, "")):
                return self._present(entry, name, branches[name])
            commit_fetched = self._fetch(f"refs/heads/{name}")
            versions = ros_versions(self._tree) if self._options.ros != "any" else ""
            if not versions or self._options.ros in versions:  # a checkout without packages might be for any version
                return self._finish(entry, name, commit_fetched)
        tried = f"; {', '.join(names)} {'is' if len(names) == 1 else 'are'} not" if names else ""
        raise FetchingError("other ros", f"no branch is for ROS {self._options.ros}{tried}")

    def _check_place(self) -> None:
        """Refuse to replace anything but a clean checkout."""
        if not self._place.exists():
            return
        if not (self._place / ".git").is_dir():
            raise FetchingError("in the way", f"{self._place} is not a checkout and is in the way")
        try:
            changed = run_git(("status", "--porcelain", "--ignore-submodules=all"), folder=self._place, timeout=None)
        except subprocess.SubprocessError:
            changed = "unknown to git"
        if changed:
            raise FetchingError("in the way", f"files in {self._place} were changed")

    def _remote(self) -> tuple[str | None, dict[str, str]]:
        """Return the default branch of the repository, and its branches with their commits."""
        self._empty()
        listed = self._network("ls-remote", "--symref", "--", self._one.url, "HEAD", "refs/heads/*").decode(
            "utf-8", "replace"
        )
        matches = (_BRANCH.fullmatch(line) for line in listed.splitlines())
        branches = {match["name"]: match["commit"] for match in matches if match}
        default = _DEFAULT.search(listed)
        if not branches:
            raise FetchingError("gone", "the repository is empty")
        return default["name"] if default and default["name"] in branches else None, branches

    def _fetch(self, ref: str, commit: str = "") -> str:
        """Fetch and check out a `ref`, and return its commit."""
        self._empty()
        options = ("--quiet", "--depth=1", "--no-tags", "--no-recurse-submodules", "--no-auto-maintenance")
        self._network("fetch", *options, "--", self._one.url, ref)
        fetched = self._git("rev-parse", "--verify", "FETCH_HEAD^{commit}").decode().strip()
        if commit and fetched != commit:
            raise FetchingError("gone", f"the server sent {fetched[:12]} for {commit[:12]}")
        listing = self._git("ls-tree", "-r", "-l", "-z", "--full-tree", fetched)
        self._bytes = content_bytes(listing)
        if self._bytes + folder_bytes(self._tree) > self.watch.room:
            raise self.watch.large()
        self._git("checkout", "--quiet", "--force", "--detach", fetched)
        return fetched

    def _empty(self) -> None:
        """Start with an empty repository."""
        shutil.rmtree(self._tree, ignore_errors=True)
        self._tree.mkdir(parents=True)
        self._git("init", "--quiet", "--template=")

    def _finish(self, pinned: Entry, branch: str, commit: str) -> Entry:
        """Move the checkout into place."""
        remarks = self._submodules() if self._options.submodules else []
        links = outward_links(self._tree)
        if links:  # git must not report them as changes of the checkout, which would then never be replaced
            self._git(
                "update-index",
                "--skip-worktree",
                "-z",
                "--stdin",
                given="\0".join(links).encode(errors="surrogateescape"),
            )
            for link in links:
                (self._tree / link).unlink()
            remarks.append(f"left out {len(links)} link{'s' * (len(links) > 1)} that lead out, as {links[0]}")
        self._git("config", "remote.origin.url", without_password(self._one.url))
        self.watch.weigh()
        entry = self._entry(pinned, branch, commit, self._tree)
        self._put()
        return replace(entry, reason="; ".join(remarks))

    def _present(self, pinned: Entry, branch: str, commit: str) -> Entry:
        """Return the entry of a checkout that is already complete."""
        try:
            listing = run_git(("ls-tree", "-r", "-l", "-z", "--full-tree", commit), folder=self._place, timeout=None)
        except subprocess.SubprocessError:
            raise FetchingError("in the way", f"the checkout at {self._place} lacks files of its commit") from None
        self._bytes = content_bytes(listing.encode(errors="surrogateescape"))
        return self._entry(pinned, branch, commit, self._place)

    def _entry(self, pinned: Entry, branch: str, commit: str, checkout: Path) -> Entry:
        return replace(
            pinned,
            moved=self._moved or pinned.moved,
            branch=branch,
            commit=commit,
            ros=ros_versions(checkout),
            bytes=self._bytes,
            state=FETCHED,
            reason="",
        )

    def _put(self) -> None:
        self._place.parent.mkdir(parents=True, exist_ok=True)
        before = self._tree.with_name("before")
        if self._place.exists():
            self._place.rename(before)
        try:
            self._tree.rename(self._place)
        except OSError:
            if before.exists():
                before.rename(self._place)
            raise

    def _submodules(self) -> list[str]:
        options = ("update", "--init", "--recursive", "--depth=1", "--quiet")
        self._git("config", "remote.origin.url", self._one.url)
        try:
            self._network("submodule", *options)
        except FetchingError as error:
            if error.state in {"too large", "too slow"}:
                raise
            return [f"submodules were not fetched: {error.reason}"]
        return []

    def _network(self, *arguments: str) -> bytes:
        output = self.watch.git(*arguments, within=self._tree, protocols=self._protocols)
        moved = _MOVED.search(self.watch.words)
        if moved:
            self._moved = without_password(moved[1]).removesuffix("/").removesuffix("/info/refs")
        return output

    def _git(self, *arguments: str, given: bytes = b"") -> bytes:
        return self.watch.git(*arguments, within=self._tree, given=given)
