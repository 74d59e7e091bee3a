"""The documentation matches the code: every feature is documented, and every example shows real output."""

from __future__ import annotations

import re
import shutil
import sys
import tomllib
from functools import cache
from shutil import which
from typing import TYPE_CHECKING, Any, Final

import pytest
import typer.main
from forks import programs
from repository import ROOT, files

from kg.cli.app import app
from kg.errors import CATALOGUE, Exit
from kg.query import stored
from kg.settings import DECLARED

sys.path.append(str(ROOT / "docs"))
import generate
import transcripts

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

DOCS: Final = ROOT / "docs"
README: Final = ROOT / "README.md"
SET_UP: Final = "python3 -m venv .venv && .venv/bin/pip install -e . && .venv/bin/kg demo"
SHOWS_A_FIRST_BUILD: Final = "quickstart.md"
RUN_TESTS: Final = ".venv/bin/pip install -e '.[dev]' && .venv/bin/pytest -n auto --dist worksteal"

_LINK: Final = re.compile(r"!?\[[^\]]*\]\((?P<target>[^)\s]+)\)")
_FENCED: Final = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


@cache
def text(path: Path) -> str:
    """Return the text of a page."""
    return path.read_text(encoding="utf-8")


def pages() -> list[Path]:
    """Return every Markdown page of the repository."""
    return [path for path in files() if path.suffix == ".md" and "cases" not in path.parts]


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as GitHub generates them."""
    headings = re.findall(r"^#+ (.*)$", _FENCED.sub("", text(page)), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def command_paths(command: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield every command below a group with the words that call it."""
    for name, below in getattr(command, "commands", {}).items():
        if not below.hidden:
            yield f"{path} {name}", below
            yield from command_paths(below, f"{path} {name}")


COMMANDS: Final = dict(command_paths(typer.main.get_command(app), "kg"))


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_documented(name: str) -> None:
    """Every command has a heading in docs/cli.md, its options are listed there, and its help begins with a sentence."""
    manual = text(DOCS / "cli.md")
    assert re.search(rf"^#+ `?{name}`?\s*$", manual, re.MULTILINE), name
    assert (COMMANDS[name].help or "").split("\n")[0].strip(), name
    options = [param.opts[-1] for param in COMMANDS[name].params if param.param_type_name == "option"]
    assert not [option for option in options if option not in manual]


@pytest.mark.parametrize("page", generate.PAGES)
def test_pages_made_from_the_code_are_fresh(page: str) -> None:
    """Generated pages are current; `python docs/generate.py` updates them."""
    assert text(DOCS / page) == generate.PAGES[page]()


def test_every_code_is_documented_with_its_way_out() -> None:
    """Every heading of the page of error codes is an entry, in ascending order, that ends in instructions."""
    headings = re.findall("^### ([^:]*)", text(DOCS / "errors.md"), re.MULTILINE)
    assert headings == sorted(headings) == list(CATALOGUE)
    assert not [code for code, entry in CATALOGUE.items() if not entry.way_out.endswith(".")]


def test_every_exit_code_is_documented() -> None:
    """The page of error codes lists exactly the exit codes of the process."""
    codes = re.findall(r"^\| (\d+) \|", text(DOCS / "errors.md"), re.MULTILINE)
    assert codes == [str(int(code)) for code in Exit]


def test_every_code_is_used() -> None:
    """Every code of the catalogue is reported by code or by a rule."""
    parts = {("kg", ".py"), ("rules", ".rq"), ("rules", ".srl")}
    paths = (path for path in files() if (path.relative_to(ROOT).parts[0], path.suffix) in parts)
    code = "\n".join(text(path) for path in paths)
    assert not [entry for entry in CATALOGUE if f'"{entry}"' not in code]


def test_every_setting_is_documented() -> None:
    """Every setting is documented as flag and variable, and as key unless files may not set it."""
    manual = text(DOCS / "settings.md")
    for setting in DECLARED.values():
        names = (*((setting.name,) if setting.in_files else ()), setting.flag, setting.variable)
        assert all(f"`{name}" in manual for name in names), setting.name


def test_every_stored_query_is_documented() -> None:
    """Every shipped query has a heading and a description of its answer."""
    manual = text(DOCS / "queries.md")
    for name, query in stored.discover().items():
        assert f"### `{name}`\n" in manual
        assert query.title not in {"", name}, name
        assert query.description.endswith(".") or query.title.endswith("?"), name


@pytest.mark.parametrize("page", pages(), ids=[str(page.relative_to(ROOT)) for page in pages()])
def test_links_lead_somewhere(page: Path) -> None:
    """A link to a file of the repository leads to an existing file and heading."""
    dead = []
    for found in _LINK.finditer(_FENCED.sub("", text(page))):
        target, _, anchor = found["target"].partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        path = (page.parent / target).resolve() if target else page
        if not path.exists() or (anchor and path.suffix == ".md" and anchor not in anchors(path)):
            dead.append(found["target"])
    assert not dead


def test_the_documentation_has_an_index() -> None:
    """The README links to docs/README.md, which links to every other page of docs/."""
    assert "(docs/README.md)" in text(README)
    index = text(DOCS / "README.md")
    assert not [page.name for page in DOCS.glob("*.md") if page.name != "README.md" and f"({page.name})" not in index]


def test_every_extra_is_documented() -> None:
    """The table of docs/install.md lists every extra of pyproject.toml except that for contributors."""
    extras = tomllib.loads(text(ROOT / "pyproject.toml"))["project"]["optional-dependencies"]
    table = text(DOCS / "install.md").partition("\n## Extras\n")[2].partition("\n## ")[0]
    rows = [row.split("|")[1] for row in table.splitlines() if row.startswith("| `")]
    assert sorted(re.findall(r"`(\w+)`", " ".join(rows))) == sorted(set(extras) - {"dev"})


def test_two_lines_set_everything_up() -> None:
    """The README has the two lines needed on a fresh machine, and CI runs the second word for word."""
    assert SET_UP in text(README)
    assert RUN_TESTS in text(README)
    assert RUN_TESTS in text(ROOT / ".ci" / "run")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A copy of the checkout next to `kg`, in which the examples are built; commands are forked."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(transcripts, "PROGRAMS", programs())
        clone = generate.checkout(tmp_path_factory.mktemp("sessions"))
        transcripts.run("kg build examples/workspace", clone)
        yield shutil.copytree(clone, clone.with_name("built"))


def reset(built: Path) -> Path:
    """Restore the checkout: a build at the same path reads nothing of an earlier one."""
    clone = built.with_name("kg")
    shutil.rmtree(clone)
    return shutil.copytree(built, clone)


@pytest.mark.skipif(not (ROOT / ".git").exists() or not which("git"), reason="sessions are those of a git checkout")
@pytest.mark.parametrize("page", generate.SESSIONS)
def test_sessions_show_what_happens(page: str, built: Path, tmp_path: Path) -> None:
    """The commands in README and quick start print the output shown; `python docs/generate.py` updates it."""
    path = (DOCS / page).resolve()
    assert transcripts.commands(text(path))
    clone = generate.checkout(tmp_path) if page == SHOWS_A_FIRST_BUILD else reset(built)
    assert transcripts.masked(generate.session(path, clone)) == transcripts.masked(text(path))
