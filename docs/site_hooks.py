"""Hooks of mkdocs: pages of the repository outside of docs/, and links that work on GitHub and on the site.

mkdocs.yml names this file. Links are written for GitHub. On the site, a link to a page outside of docs/ leads to its
copy, and one to another file leads to the repository, if its address is set.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mkdocs.structure.files import File

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

__all__ = ["on_files", "on_page_markdown"]

_ROOT: Final = Path(__file__).resolve().parent.parent
_DOCS: Final = _ROOT / "docs"
_OUTSIDE: Final = {
    "README.md": "about.md",
    "CHANGELOG.md": "CHANGELOG.md",
    "CONTRIBUTING.md": "CONTRIBUTING.md",
    "THREAT_MODEL.md": "THREAT_MODEL.md",
    "examples/workspace/README.md": "examples/workspace/README.md",
}
"""Pages outside of docs/, and where they are on the site."""
_SOURCES: Final = {site: path for path, site in _OUTSIDE.items()}
_LINK: Final = re.compile(r"(?P<picture>!?)\[(?P<text>(?:!\[[^\]]*\]\([^)]*\)|[^\[\]])*)\]\((?P<target>[^)\s]+)\)")
_FENCED: Final = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)
_CODE: Final = re.compile(r"`[^`\n]*`")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages outside of docs/."""
    for path, site in _OUTSIDE.items():
        files.append(File.generated(config, site, content=(_ROOT / path).read_text(encoding="utf-8")))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:  # noqa: ARG001 - mkdocs gives it
    """Turn links and tables as GitHub reads them into those of the site."""
    site = page.file.src_uri
    folder = (_ROOT / _SOURCES[site]).parent if site in _SOURCES else (_DOCS / site).parent
    parts = _FENCED.split(markdown)
    return "".join(part if index % 2 else _mended(part, site, folder, config) for index, part in enumerate(parts))


def _mended(text: str, site: str, folder: Path, config: MkDocsConfig) -> str:
    lines = [_unescaped(line) if line.startswith("|") else line for line in text.split("\n")]
    return _LINK.sub(lambda found: _link(found, site, folder, config), "\n".join(lines))


def _unescaped(row: str) -> str:
    """GitHub needs a backslash before a bar in the code of a table, and Python-Markdown would show it."""
    return _CODE.sub(lambda code: code.group().replace(r"\|", "|"), row)


def _link(found: re.Match[str], site: str, folder: Path, config: MkDocsConfig) -> str:
    text = _LINK.sub(lambda inner: _link(inner, site, folder, config), found["text"])
    address, mark, anchor = found["target"].partition("#")
    if not address or re.match(r"[a-z]+:", address):
        return f"{found['picture']}[{text}]({found['target']})"
    path = (folder / address).resolve()
    name = path.relative_to(_ROOT).as_posix()
    if name in _OUTSIDE or path.is_relative_to(_DOCS):
        target = _OUTSIDE.get(name) or path.relative_to(_DOCS).as_posix()
        return f"{found['picture']}[{text}]({os.path.relpath(target, Path(site).parent)}{mark}{anchor})"
    repository = str(config.repo_url or "").rstrip("/")
    return f"[{text}]({repository}/blob/HEAD/{name}{mark}{anchor})" if repository else text
