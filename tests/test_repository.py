"""Content that must never be in the repository."""

from __future__ import annotations

import re
from typing import Final

from repository import ROOT, files

LARGEST_BYTES: Final = 500_000
MODEL: Final = ROOT / "kg" / "language" / "model"
"""The tagger: minutes of training, and shipped; another test checks its size."""
LARGEST_MODEL_BYTES: Final = 6_000_000

_TEXT: Final = {
    ".py",
    ".md",
    ".toml",
    ".ttl",
    ".rq",
    ".srl",
    ".json",
    ".yaml",
    ".yml",
    ".txt",
    ".cfg",
    ".sh",
    ".xml",
    "",
}

# Written in pieces so that this file does not match itself.
_MACHINE: Final = re.compile(
    r"(?<![\w.:/-])/(?:" + "|".join(["ho" + "me", "Us" + "ers", "wo" + "rk", "ro" + "ot"]) + r")/[\w.-]+"
)
_PLACEHOLDER: Final = re.compile(r"/(?:home|root)/(?:you|user|me|robot|ada|someone|somebody)\b")


def texts() -> list[tuple[str, str]]:
    """Return the text files of the repository with their names."""
    return [
        (str(path.relative_to(ROOT)), path.read_text(encoding="utf-8", errors="replace"))
        for path in files()
        if path.suffix in _TEXT and "cases" not in path.parts and path.stat().st_size < LARGEST_BYTES
    ]


def test_no_path_of_a_developers_machine() -> None:
    """No file names a folder of a developer's machine."""
    found = [
        f"{name}:{number}: {line.strip()[:120]}"
        for name, text in texts()
        for number, line in enumerate(text.splitlines(), 1)
        if _MACHINE.search(_PLACEHOLDER.sub("", line))
    ]
    assert not found


def test_no_large_or_generated_files() -> None:
    """Generated files are not committed, and only the shipped tagger is large."""
    unwanted = {".pyc", ".so", ".whl", ".egg", ".nq", ".sst"}
    assert not [
        str(path.relative_to(ROOT))
        for path in files()
        if path.suffix in unwanted
        or (path.stat().st_size > LARGEST_BYTES and "cases" not in path.parts and MODEL not in path.parents)
    ]


def test_the_tagger_is_small() -> None:
    """The model in every installation has at most a few megabytes."""
    sizes = [path.stat().st_size for path in files() if MODEL in path.parents]
    assert sizes
    assert sum(sizes) < LARGEST_MODEL_BYTES
