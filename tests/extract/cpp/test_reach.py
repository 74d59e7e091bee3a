"""Words in code as seen by the search for effects."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.workspaces import reader_of

from kg.extract.buildmodel import BuildModel
from kg.extract.cpp.project import Project
from kg.symbolic.descriptions import merged

if TYPE_CHECKING:
    from pathlib import Path

NAMES = [f"called{number}" for number in range(20)]
FILES: dict[str, str | bytes] = {
    "main.cpp": "".join(f"void {name}() {{}}\n" for name in NAMES) + "int main() { WRAPPED(1); }\n",
    "other.cpp": '#include "wrapped.h"\nvoid other() { advertise(); }\n',
    "wrapped.h": "#define WRAPPED(x) hidden(x)\n",
}


@pytest.fixture
def project(tmp_path: Path) -> Project:
    """Return a project with one program, `main.cpp`."""
    reader = reader_of(tmp_path, FILES)
    made = Project(reader, reader.package, BuildModel(), merged(()))
    add(made, "main.cpp")
    return made


def add(project: Project, path: str) -> None:
    """Add a file of the package to the programs of a project."""
    unit = project.unit(project.own(f"demo/{path}"))
    assert unit is not None
    project.add_unit(unit)


def test_definitions_are_found_in_the_same_order_in_each_process(project: Project) -> None:
    """The lookups of files are stored with the facts."""
    assert [one.name for one in project.definitions(frozenset(NAMES))] == sorted(NAMES)


def test_a_word_is_searched_in_files_that_are_added_later(project: Project) -> None:
    """An added file may contain a word missing in earlier ones."""
    assert not project.mentions("advertise")
    add(project, "other.cpp")
    assert project.mentions("advertise")


def test_words_contain_what_a_macro_that_is_added_later_expands_to(project: Project) -> None:
    """An added header may define a macro used by earlier code."""
    unit = project.unit(project.own("demo/main.cpp"))
    assert unit is not None
    (main,) = unit.functions["main"]
    assert "hidden" not in (project.words(main) or ())
    add(project, "wrapped.h")
    assert "hidden" in (project.words(main) or ())
