"""What breaks in a small workspace: each file of `cases` has a name as it is typed, and what the view answers.

`KG_WRITE_EXPECTED=1` writes the answers anew; the difference shows what changed.
"""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from kg.errors import UnknownNameError, UsageError
from kg.pipeline.build import build
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.views.impact import impact

if TYPE_CHECKING:
    from kg.settings import Settings

HERE = Path(__file__).parent
CASES = sorted((HERE / "cases").glob("*.json"))


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> EmbeddedStore:
    """Return the store of the workspace."""
    root = tmp_path_factory.mktemp("impact")
    shutil.copytree(HERE / "cases" / "workspace", root / "harbour")
    found = EmbeddedStore.create(root / ".kg")
    build([str(root / "harbour")], found, settings())
    return found


def settings() -> Settings:
    """Return the settings that nobody changed."""
    return load({}, environment={})


def asked(store: EmbeddedStore, name: str, kind: str = "") -> dict[str, Any]:
    """Return what the view answers."""
    with store.read() as snapshot:
        return impact(snapshot, settings(), name=name, kind=kind)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_answer(store: EmbeddedStore, path: Path) -> None:
    """Each effect has its grade, its reason and its line."""
    case = json.loads(path.read_text())
    found = asked(store, case["asked"], case.get("as", ""))
    if os.environ.get("KG_WRITE_EXPECTED"):
        path.write_text(json.dumps({**case, "answer": found}, indent=1) + "\n")
    assert found == case["answer"]


def test_what_means_several_things_gets_a_command_for_each(store: EmbeddedStore) -> None:
    """`limit` is a parameter of the hoist and an argument of its launch file."""
    with pytest.raises(UsageError) as raised:
        asked(store, "limit")
    assert raised.value.hint == "`kg impact limit --kind parameter`\n`kg impact limit --kind argument`"


def test_an_unknown_name_gets_those_that_were_meant(store: EmbeddedStore) -> None:
    """Also within one kind."""
    with pytest.raises(UnknownNameError) as raised:
        asked(store, "crane_msgs/Laod", "type")
    assert "`crane_msgs/Load`" in (raised.value.hint or "")
    with pytest.raises(UsageError, match="unknown kind `topics`"):
        asked(store, "lift", "topics")
