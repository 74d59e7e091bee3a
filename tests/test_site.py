"""The documentation site builds without a warning."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from typing import TYPE_CHECKING, Any, Final

import pytest
import yaml
from repository import ROOT

if TYPE_CHECKING:
    from pathlib import Path

pytest.importorskip("mkdocs", reason="mkdocs is not installed: pip install -e '.[site]'")

_ADDRESS: Final = "https://example.org/robots/kg"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site once, strictly: a dead link, a missing anchor or a page outside the navigation fails."""
    target = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(target)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "KG_REPOSITORY": _ADDRESS}
    ran = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False, timeout=300)
    assert ran.returncode == 0, ran.stderr
    return target


def page(site: Path, name: str) -> str:
    """Return the HTML of a page."""
    return (site / name).read_text("utf-8")


def test_links_lead_to_pages_and_to_the_repository(site: Path) -> None:
    """A link to a page of the repository leads to the site; a link to another file leads to the repository."""
    assert 'href="THREAT_MODEL.html"' in page(site, "about.html")
    assert 'href="examples/workspace/index.html"' in page(site, "quickstart.html")
    assert f'href="{_ADDRESS}/blob/HEAD/rules/owl/prp-symp.rq"' in page(site, "rules.html")


def test_tables_are_tables(site: Path) -> None:
    """No row is rendered as text, and no backslash precedes a bar."""
    for path in site.rglob("*.html"):
        body = re.sub(r"<(pre|code)\b.*?</\1>", "", path.read_text("utf-8"), flags=re.DOTALL)
        assert not re.search(r"<p>\|.*\|", body), path.name
    assert "<code>--ros 1|2</code>" in page(site, "cli.html")


def test_nothing_is_loaded_from_other_servers(site: Path) -> None:
    """Scripts, styles and pictures come from the site itself."""
    for path in site.rglob("*.html"):
        sources = re.findall(r"<(?:script|img|iframe)[^>]* src=\"?([^\" >]+)", path.read_text("utf-8"))
        styles = re.findall(r"<link rel=\"?stylesheet\"? href=\"?([^\" >]+)", path.read_text("utf-8"))
        assert not [each for each in sources + styles if re.match(r"(?:[a-z]+:)?//", each)], path.name


def test_the_navigation_is_that_of_the_index() -> None:
    """Every page in docs/README.md is in the navigation group named by its heading."""
    groups: dict[str, str] = {}
    index = (ROOT / "docs" / "README.md").read_text("utf-8")
    for heading, body in re.findall(r"^## (?:For )?(.*)\n\n((?:.+\n)+)", index, re.MULTILINE):
        groups |= dict.fromkeys(re.findall(r"\]\(([\w/.-]+\.md)\)", body), heading)
    navigation = re.sub(r"!!python\S*|!ENV", "", (ROOT / "mkdocs.yml").read_text("utf-8"))
    nav: list[dict[str, list[Any]]] = yaml.safe_load(navigation)["nav"]
    placed = {
        path: group
        for part in nav
        for group, pages in part.items()
        for one in pages
        if isinstance(one, dict)
        for path in one.values()
    }
    wanted = {target.removeprefix("../"): heading[0].upper() + heading[1:] for target, heading in groups.items()}
    assert not {target for target, heading in wanted.items() if placed[target] not in {"Start", heading}}
