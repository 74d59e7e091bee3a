from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UsageError
from kg.shell.app import command_for

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("editor", "words"),
    [
        ("vi", ["vi", "+12", "FILE"]),
        ("nano", ["nano", "+12", "FILE"]),
        ("emacs -nw", ["emacs", "-nw", "+12", "FILE"]),
        ("/usr/bin/code --wait", ["/usr/bin/code", "--wait", "-g", "FILE:12"]),
        ("hx", ["hx", "FILE:12"]),
        ("pycharm", ["pycharm", "--line", "12", "FILE"]),
    ],
)
def test_editors_are_told_the_line_in_their_manner(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, editor: str, words: list[str]
) -> None:
    """The line is an option before the file, or follows it, as the editor expects."""
    file = tmp_path / "a b.cpp"
    file.write_text("")
    monkeypatch.delenv("VISUAL", raising=False)
    monkeypatch.setenv("EDITOR", editor)
    assert command_for(file, 12) == [word.replace("FILE", str(file)) for word in words]
    assert command_for(file, None)[-1] == str(file)


def test_visual_wins_over_editor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """VISUAL takes precedence, as in other programs."""
    monkeypatch.setenv("VISUAL", "emacs")
    monkeypatch.setenv("EDITOR", "vi")
    (tmp_path / "a").write_text("")
    assert command_for(tmp_path / "a", 1)[0] == "emacs"


def test_without_any_editor_there_is_a_way_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """KG551 explains how to set an editor."""
    for name in ("VISUAL", "EDITOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    (tmp_path / "a").write_text("")
    with pytest.raises(UsageError) as caught:
        command_for(tmp_path / "a", 1)
    assert caught.value.code == "KG551"
    assert "EDITOR" in (caught.value.hint or "")


def test_a_file_that_is_not_here_is_told(tmp_path: Path) -> None:
    """KG552 names the file."""
    with pytest.raises(UsageError, match="gone") as caught:
        command_for(tmp_path / "gone.cpp", 1)
    assert caught.value.code == "KG552"
