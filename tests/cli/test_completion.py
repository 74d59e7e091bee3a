from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from cli.rover import build

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("kg no", ["nodes", "node"]),
        ("kg node dr", ["driver"]),
        ("kg topic /od", ["/odom"]),
        ("kg topic od", ["odom"]),
        ("kg service /", ["/driver/reset", "/map"]),
        ("kg action /d", ["/dock"]),
        ("kg impact /o", ["/odom"]),
        ("kg impact dr", ["driver", "driver/reset"]),
        ("kg nodes --package rover_", ["rover_base", "rover_sim"]),
        ("kg query who-", []),
        ("kg query explore/who-", ["explore/who-loads-plugin", "explore/who-publishes", "explore/who-subscribes"]),
        ("kg explain KG60", ["KG601", "KG602", "KG603", "KG604", "KG605"]),
    ],
)
def test_tab_offers_what_there_is(kg: Program, tmp_path: Path, words: str, offered: list[str]) -> None:
    """Commands, nodes, packages, stored queries and codes are completed from their first letters."""
    build(tmp_path / ".kg")
    position = str(words.count(" "))
    run = kg(_KG_COMPLETE="complete_bash", COMP_WORDS=words, COMP_CWORD=position)
    assert (run.code, run.err) == (0, "")
    assert run.out.split() == offered


def test_tab_without_a_store_offers_nothing_and_says_nothing(kg: Program) -> None:
    """Completion never disturbs the edited line."""
    run = kg(_KG_COMPLETE="complete_bash", COMP_WORDS="kg node dr", COMP_CWORD="2")
    assert (run.out.strip(), run.err) == ("", "")
