"""Load a spaCy pipeline, the shipped one or the user's, once per process.

`identity` identifies it without loading anything, so a build without changes is fast.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import UsageError
from kg.lazily import lazily

if TYPE_CHECKING:
    from spacy.language import Language

with lazily():
    from importlib.metadata import version

    import spacy

    from kg.language.shipping import load

SHIPPED: Final = Path(__file__).resolve().parent / "model"
"""Folder of the shipped model."""

_PROBE: Final = "This robot moves."
_NEEDED: Final = (("POS", "parts of speech"), ("LEMMA", "lemmas"))
_UNUSED: Final = (
    "ner",
    "parser",
    "senter",
    "textcat",
    "textcat_multilabel",
    "entity_linker",
    "entity_ruler",
    "spancat",
)
"""Components that cost time and are not used here."""


def identity(model: str) -> str:
    """Return an identifier of a pipeline and its version, without loading it.

    The empty name is the shipped one, which is part of the code of `kg`. The files of others may be large, so only
    their sizes and times are used.
    """
    if not model:
        return model
    folder = Path(model).expanduser()
    if (folder / "meta.json").is_file():
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        stats = ((path, path.stat()) for path in files)
        return " ".join(f"{path.relative_to(folder)} {one.st_size} {one.st_mtime_ns}" for path, one in stats)
    from importlib.metadata import PackageNotFoundError  # noqa: PLC0415 - start-up time

    try:
        return f"{model} {version(model)}"
    except (PackageNotFoundError, ValueError):
        return model


def describe(model: str) -> str:
    """Return the display name and version of a pipeline, without loading it."""
    folder = SHIPPED if not model else Path(model).expanduser()
    try:
        meta = json.loads((folder / "meta.json").read_text("utf-8"))
        name = f"{meta['lang']}_{meta['name']} {meta['version']}"
    except (OSError, ValueError, KeyError):
        return identity(model)
    return f"{name} (shipped with kg)" if not model else f"{name} ({folder})"


@cache
def pipeline(model: str) -> Language:
    """Return the pipeline of that name or path, without unused components; the empty name is the shipped one.

    Raises:
        UsageError: KG141 if it cannot be loaded, KG142 if it does not set parts of speech and lemmas.
    """
    nlp = _named(model) if model else load(SHIPPED)
    probe = nlp(_PROBE) if model else None
    missing = [words for attribute, words in _NEEDED if probe and not probe.has_annotation(attribute)]
    if missing:
        hint = "Name one with a tagger or morphologizer and a lemmatizer, or leave `nlp_model` empty."
        raise UsageError("KG142", f"the spaCy pipeline {model!r} sets no {' and no '.join(missing)}", hint=hint)
    return nlp


def _named(model: str) -> Language:
    try:
        return spacy.load(Path(model).expanduser() if "/" in model else model, exclude=list(_UNUSED))
    except (ImportError, OSError, TypeError, ValueError, KeyError, AttributeError) as problem:
        lines = str(problem).strip().splitlines() or [type(problem).__name__]
        hint = "`python -m spacy validate` lists those installed; without `nlp_model` kg uses its own."
        raise UsageError("KG141", f"spaCy cannot load the pipeline {model!r}: {lines[0]}", hint=hint) from None
