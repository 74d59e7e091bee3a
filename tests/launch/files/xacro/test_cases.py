"""Cases are files: `cases/CASE/PACKAGE/...` are descriptions, `case.toml` has the plugins of one of them.

A line `! KIND PLACE: MESSAGE` is a problem; places are those of files, followed by `<` and their includes.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from extract.workspaces import manifest, written

from kg.corpus.files import FilePath
from kg.corpus.reading import Reader
from kg.launch.files.access import Files
from kg.launch.files.xacro.plugins import Descriptions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.facts import Location
    from kg.launch.files.xacro.plugins import Read

CASES = sorted((Path(__file__).parent / "cases").glob("*/case.toml"))


def shown(read: Read) -> Iterator[str]:
    """Yield the lines in the notation of a case."""
    for plugin in read.plugins:
        condition = f" if {plugin.condition}" if plugin.condition else ""
        yield f"{plugin.library} {plugin.name} {place(plugin.location, plugin.chain)}{condition}"
        yield from (f"  {one.element} = {one.text} :{one.location.line}" for one in plugin.values)
    yield from (f"! {one.kind} {place(one.location, ())}: {one.message}" for one in read.problems)


def place(location: Location, chain: tuple[Location, ...]) -> str:
    """Return a place with its includes."""
    return " < ".join(map(str, (location, *chain)))


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.parent.name)
def test_case(case: Path, tmp_path: Path) -> None:
    """A description has the plugins expected by its case, with the lines of their elements."""
    expected = tomllib.loads(case.read_text("utf-8"))
    folder = case.parent
    files = {str(path.relative_to(folder)): path.read_bytes() for path in folder.glob("*/**/*") if path.is_file()}
    workspace = written(tmp_path, {**files, "demo/package.xml": manifest("demo")})
    (source,) = workspace.sources
    reader = Reader(workspace, source, source.packages[0])
    file = FilePath(source.repository.name, expected["file"])
    found = Descriptions(Files(reader), file, {}).read(file, expected.get("arguments", {}), ())
    assert list(shown(found)) == expected["expect"].strip("\n").splitlines()
