"""Stores of commits: a repository at a commit, read once and cached in the user's cache.

The commit is checked out into a separate folder that borrows the objects of the repository, so the repository and its
work tree are not modified. The folder is deleted after reading; the store remains for the next use. Nothing is fetched.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from contextlib import contextmanager
from dataclasses import replace
from hashlib import blake2b
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.corpus.git import describe, run_git
from kg.corpus.sources import is_address
from kg.errors import Place, SourceError
from kg.pipeline.build import build
from kg.pipeline.plan import version
from kg.pipeline.reasoning import digest
from kg.pipeline.state import load
from kg.store.backups import back_up
from kg.store.embedded import EmbeddedStore
from kg.store.failure import translated
from kg.store.layout import Layout, user_cache

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.pipeline.report import Report
    from kg.settings import Settings

_CHECKOUT_SECONDS: Final = 600.0

Revision: TypeAlias = str
"""A commit's full hash."""


def resolve(folder: Path, name: str) -> Revision:
    """Return the hash of the commit `name` in the repository of `folder`.

    Raises:
        SourceError: KG101 without a repository or git, KG104 for an unknown commit.
    """
    _top(folder)
    try:
        return run_git(
            ("rev-parse", "--verify", "--quiet", "--end-of-options", f"{name}^{{commit}}"), folder=folder
        ).strip()
    except subprocess.SubprocessError:
        shallow = _rev_parse(folder, "--is-shallow-repository") == "true"
        hint = (
            "The clone is shallow: `git fetch --unshallow` brings the rest." if shallow else "`git log` lists commits."
        )
        raise SourceError(
            "KG104", f"the repository has no commit `{name}`", place=Place(str(folder)), hint=hint
        ) from None


def merge_base(folder: Path, one: Revision, other: Revision) -> Revision:
    """Return the merge base of two commits; SourceError KG104 if they have none."""
    try:
        return run_git(("merge-base", one, other), folder=folder).strip()
    except subprocess.SubprocessError:
        message = f"{one[:12]} and {other[:12]} have no commit in common"
        raise SourceError("KG104", message, place=Place(str(folder)), hint="Compare them with two dots.") from None


def revision_store(folder: Path, revision: Revision, settings: Settings, report: Report | None = None) -> EmbeddedStore:
    """Return the store of a commit of the repository of `folder`, from the cache if available.

    A new store begins as a copy of that of another commit, so only packages that differ are read.

    Raises:
        SourceError: KG103 if the commit cannot be checked out (objects missing from a partial clone, a full disk).
        StoreError: as a build.
    """
    top = _top(folder)
    # The name depends on everything that the content of the store does.
    parts = str(top), version(settings), digest(settings) or ""
    short = blake2b("\0".join(parts).encode(errors="surrogateescape"), digest_size=8).hexdigest()
    root = user_cache() / "revisions" / f"{revision}-{short}"
    if root.is_dir() and Layout(root).current() is not None:
        return EmbeddedStore(Layout(root))
    with translated(str(root)):
        root.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix="reading-", dir=root.parent) as scratch:
        tree, target = Path(scratch) / (top.name or "root"), Path(scratch) / ".kg"
        _check_out(top, revision, tree)
        store = _copied(_newest(root), target)
        build([str(tree)], store, replace(settings, store=target), report, f"kg diff, at {revision[:12]}")
        with translated(str(root)):
            try:
                target.rename(root)
            except OSError:
                if not root.is_dir():
                    raise
    return EmbeddedStore(Layout(root))


def _newest(root: Path) -> EmbeddedStore | None:
    """Return the last store of another commit that the same program made of the same repository; None without one."""
    others = root.parent.glob(f"*-{root.name.rpartition('-')[2]}")
    complete = [path for path in others if Layout(path).current() is not None]
    return EmbeddedStore(Layout(max(complete, key=lambda path: path.stat().st_mtime))) if complete else None


@contextmanager
def commit_and_work_tree(
    folder: Path, revision: Revision, store: EmbeddedStore | None, settings: Settings, report: Report | None = None
) -> Iterator[tuple[EmbeddedStore, EmbeddedStore]]:
    """Yield the stores of a commit and of the work tree of the repository of `folder`, both with all other sources.

    Both begin as copies of `store`, so only differences are read; `store` is unchanged. They are deleted at the end.
    Nothing is fetched.

    Raises:
        SourceError: KG103 if the commit cannot be checked out.
        StoreError: as a build.
    """
    top = _top(folder)
    parent = store.layout.root if store else user_cache()
    with translated(str(parent)):
        parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix="impact-", dir=parent) as scratch:
        after = _copied(store, Path(scratch) / "after")
        tree = Path(scratch) / (top.name or "root")
        _read_again(after, top, top, settings, report)
        before = _copied(after, Path(scratch) / "before")
        _check_out(top, revision, tree)
        _read_again(before, top, tree, settings, report)
        yield before, after


def _copied(store: EmbeddedStore | None, root: Path) -> EmbeddedStore:
    """Return a copy of a store that shares its files, which are replaced and never edited; an empty store for None."""
    if store is None or store.layout.current() is None:
        return EmbeddedStore.create(root)
    back_up(store.layout, root)
    for name in ("cache", "changes"):
        source = store.layout.root / name
        if source.is_dir():
            shutil.copytree(source, root / name, copy_function=_share, ignore=shutil.ignore_patterns("*.tmp"))
    return EmbeddedStore.create(root)


def _share(source: str, target: str) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)


def _read_again(store: EmbeddedStore, top: Path, tree: Path, settings: Settings, report: Report | None) -> None:
    """Build the sources of a store again, with `tree` in place of the checkout `top`."""
    roots: dict[str, None] = {}
    state = load(store.layout.cache)
    for root in state.roots:
        path = Path(root)
        if not is_address(root) and path.is_dir() and path.resolve().is_relative_to(top):
            roots[str(tree / path.resolve().relative_to(top))] = None
            continue
        for source in state.sources.values():
            own = Path(source.repository.root).resolve()
            roots[str(tree if own == top else own)] = None
    build([*(roots or {str(tree): None})], store, replace(settings, store=store.layout.root), report, "kg impact")


def _top(folder: Path) -> Path:
    try:
        return Path(run_git(("rev-parse", "--show-toplevel"), folder=folder).rstrip("\n")).resolve()
    except OSError as error:
        raise SourceError("KG101", "git is not installed", hint="Install git to compare commits.") from error
    except subprocess.SubprocessError:
        hint = "Go into a checkout, or name one with --repository; two stores can be compared without git."
        raise SourceError("KG101", "not a git repository", place=Place(str(folder)), hint=hint) from None


def _rev_parse(folder: Path, question: str) -> str:
    return run_git(("rev-parse", question), folder=folder).strip()


def _check_out(top: Path, revision: Revision, tree: Path) -> None:
    """Write the files of a commit into a new folder, a repository with the name and remote of the one at `top`."""
    try:
        _borrow_objects(top, tree)
        run_git(("checkout", "--quiet", "--detach", revision), folder=tree, timeout=_CHECKOUT_SECONDS)
    except subprocess.SubprocessError as error:
        words = (getattr(error, "stderr", None) or b"").decode(errors="replace").strip() or str(error)
        message = f"{revision[:12]} cannot be checked out: {words.splitlines()[-1]}"
        hint = "A partial clone lacks the files of other commits; `git fetch --refetch --no-filter` brings them."
        raise SourceError("KG103", message, place=Place(str(top)), hint=hint) from error


def _borrow_objects(top: Path, tree: Path) -> None:
    """Make `tree` a repository that borrows the objects of the one at `top`, with the same remote."""
    tree.mkdir()
    run_git(("init", "--quiet"), folder=tree)
    common = (top / _rev_parse(top, "--git-common-dir")).resolve()
    (tree / ".git" / "objects" / "info" / "alternates").write_text(f"{common / 'objects'}\n", encoding="utf-8")
    if (common / "shallow").is_file():
        shutil.copyfile(common / "shallow", tree / ".git" / "shallow")
    if remote := describe(top).remote:
        run_git(("config", "remote.origin.url", remote), folder=tree)
