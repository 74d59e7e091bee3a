"""A line of code in the editor of the person: `$VISUAL`, `$EDITOR`, or what there is."""

from __future__ import annotations

import os
import shlex
import shutil
from pathlib import Path
from typing import Final

from kg.errors import UsageError

_LINE_BEHIND: Final = {"code", "code-insiders", "codium", "cursor", "windsurf"}
"""Editors that take `-g FILE:LINE`."""
_LINE_AFTER_COLON: Final = {"hx", "helix", "subl", "zed", "zeditor"}
_LINE_OPTION: Final = {"clion", "idea", "pycharm", "kate", "gedit"}
_FALLBACKS: Final = ("nano", "vim", "vi", "emacs")


def editor_words() -> list[str]:
    """Return the command of the editor; UsageError KG551 when there is none."""
    for name in ("VISUAL", "EDITOR"):
        if words := shlex.split(os.environ.get(name, "")):
            return words
    found = next((name for name in _FALLBACKS if shutil.which(name)), None)
    if found is None:
        raise UsageError("KG551", "no editor was found", hint="Name one: export EDITOR=nano")
    return [found]


def command_for(path: Path, line: int | None) -> list[str]:
    """Return the command that opens `path` at `line`, in the manner of the editor.

    Raises:
        UsageError: KG551 when there is no editor, KG552 when the file is not on this machine.
    """
    if not path.is_file():
        hint = "The source may have moved; `kg status` lists the sources."
        raise UsageError("KG552", f"the file is not here: {path}", hint=hint)
    words = editor_words()
    program = Path(words[0]).name
    if line is None:
        return [*words, str(path)]
    if program in _LINE_BEHIND:
        return [*words, "-g", f"{path}:{line}"]
    if program in _LINE_AFTER_COLON:
        return [*words, f"{path}:{line}"]
    if program in _LINE_OPTION:
        return [*words, "--line", str(line), str(path)]
    return [*words, f"+{line}", str(path)]
