"""Which spaCy pipeline tags: the shipped one, or one that the user names; loaded once a process.

`identity` says which it is without loading anything, so that a build without changes stays quick.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import UsageError

if TYPE_CHECKING:
    from spacy.language import Language

SHIPPED: Final = Path(__file__).resolve().parent / "model"
"""The folder of the model that belongs to `kg`."""

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
"""Parts that cost time and give nothing that is used here."""


def identity(model: str) -> str:
    """Return what stands for a pipeline and its version; nothing is loaded.

    The empty name is the shipped one, which is part of the code of `kg`. The files of another may be large; they count
    by size and time.
    """
    if not model:
        return model
    folder = Path(model).expanduser()
    if (folder / "meta.json").is_file():
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        stats = ((path, path.stat()) for path in files)
        return " ".join(f"{path.relative_to(folder)} {one.st_size} {one.st_mtime_ns}" for path, one in stats)
    from importlib.metadata import PackageNotFoundError, version  # noqa: PLC0415 - start-up time

    try:
        return f"{model} {version(model)}"
    except (PackageNotFoundError, ValueError):
        return model


def describe(model: str) -> str:
    """Return the name and version of a pipeline for people; nothing is loaded."""
    folder = SHIPPED if not model else Path(model).expanduser()
    try:
        meta = json.loads((folder / "meta.json").read_text("utf-8"))
        name = f"{meta['lang']}_{meta['name']} {meta['version']}"
    except (OSError, ValueError, KeyError):
        return identity(model)
    return f"{name} (shipped with kg)" if not model else f"{name} ({folder})"


@cache
def pipeline(model: str) -> Language:
    """Return the pipeline of that name or path, without parts that are not used; the empty name is the shipped one.

    Raises:
        UsageError: KG141 when it cannot be loaded, KG142 when it sets no parts of speech or no lemmas.
    """
    nlp = _named(model) if model else _shipped()
    probe = nlp(_PROBE) if model else None
    missing = [words for attribute, words in _NEEDED if probe and not probe.has_annotation(attribute)]
    if missing:
        hint = "Name one with a tagger or morphologizer and a lemmatizer, or leave `nlp_model` empty."
        raise UsageError("KG142", f"the spaCy pipeline {model!r} sets no {' and no '.join(missing)}", hint=hint)
    return nlp


def _named(model: str) -> Language:
    import spacy  # noqa: PLC0415 - a second, for those who have texts to tag

    try:
        return spacy.load(Path(model).expanduser() if "/" in model else model, exclude=list(_UNUSED))
    except (ImportError, OSError, TypeError, ValueError, KeyError, AttributeError) as problem:
        lines = str(problem).strip().splitlines() or [type(problem).__name__]
        hint = "`python -m spacy validate` lists those installed; without `nlp_model` kg uses its own."
        raise UsageError("KG141", f"spaCy cannot load the pipeline {model!r}: {lines[0]}", hint=hint) from None


def _shipped() -> Language:
    from kg.language.shipping import load  # noqa: PLC0415 - imports spaCy

    return load(SHIPPED)
