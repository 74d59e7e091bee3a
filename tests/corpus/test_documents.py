"""Pages of documentation: a package's own, and surrounding ones about it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.corpus.workspace import Workspace, scan
from kg.facts import Repository

if TYPE_CHECKING:
    from pathlib import Path

MANIFEST = "<package><name>{}</name></package>"


def pages(root: Path, package: str, *paths: str) -> list[str]:
    """Return the pages of a package of a repository with the packages `laser` and `arm` and these pages."""
    for name in ("laser", "arm"):
        (root / name).mkdir(exist_ok=True)
        (root / name / "package.xml").write_text(MANIFEST.format(name))
    for path in paths:
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text("Words.\n")
    workspace = Workspace([scan(root, Repository("local/r", str(root)))])
    return [file.path for file in workspace.documents("local/r", package)]


def test_own_pages_come_first(tmp_path: Path) -> None:
    """Pages of a package precede those of the root, and READMEs precede their neighbours."""
    found = pages(tmp_path, "laser", "README.md", "laser/doc/a.rst", "laser/README.md", "laser/about.md")
    assert found == ["laser/README.md", "laser/about.md", "laser/doc/a.rst", "README.md"]


def test_pages_about_another_package_are_left_out(tmp_path: Path) -> None:
    """A page in a folder named like another package is about that package."""
    assert pages(tmp_path, "laser", "doc/arm/a.rst", "doc/laser/a.rst") == ["doc/laser/a.rst"]
    assert pages(tmp_path, "arm", "laser/README.md") == ["doc/arm/a.rst"]


def test_formal_pages_are_left_out(tmp_path: Path) -> None:
    """Change logs, licences, and pages at the root outside of `doc` are excluded."""
    assert pages(tmp_path, "laser", "laser/CHANGELOG.rst", "LICENSE", "notes/x.md", "laser/words.txt") == []


def test_an_unknown_source_has_no_pages() -> None:
    """A repository outside the build has no pages."""
    assert Workspace([]).documents("local/none", ".") == ()
