"""Results of studies with people."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UsageError
from kg.evaluate.exercises import read, table

if TYPE_CHECKING:
    from pathlib import Path

HEAD = "participant,robot,exercise,title,seconds,attempts,ended,blocks,capabilities,program\r\n"


def written(folder: Path, *rows: str) -> str:
    """Return the path of a file of results."""
    path = folder / "study.csv"
    path.write_text(HEAD + "".join(f"{row}\r\n" for row in rows), encoding="utf-8")
    return str(path)


def test_means_stand_next_to_those_of_the_paper(tmp_path: Path) -> None:
    """Times have a mean and a deviation, as in Table 2."""
    path = written(
        tmp_path,
        'a,office,1,Single command,60.0,1,done,1,1,"go to a pose  at: kitchen\n"',
        "b,office,1,Single command,80.0,2,failed,2,1,",
        "a,drone,2,Command sequence,30.4,1,stopped,2,2,",
    )
    assert table(read(path)).rows == (
        ("1 Single command", "office", 2, "1:10 ± 0:14", "1.5", 1, "1.5", "1", "1:22 ± 0:42"),
        ("2 Command sequence", "drone", 1, "0:30", "1", 1, "2", "2", "1:16 ± 0:08"),
    )


def test_other_files_are_refused(tmp_path: Path) -> None:
    """A row that is not a result is reported with its line."""
    with pytest.raises(UsageError, match="not a result of a study") as error:
        read(written(tmp_path, "a,office,one"))
    assert error.value.place is not None
    assert error.value.place.line == 2
    with pytest.raises(UsageError, match="cannot be read"):
        read(str(tmp_path / "none.csv"))
