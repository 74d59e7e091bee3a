"""Read and write the shipped model: the folder of a spaCy pipeline with its numbers in half precision.

Half precision halves the size of the folder, and changes less than one tag in a thousand. In memory the numbers are
converted to 32 bits, which spaCy computes with.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

from spacy.util import load_config, load_model_from_config
from thinc.api import Model, use_ops

import kg.language.embedding
import kg.language.lemmas
import kg.language.tokenizer  # noqa: F401 - registers components named in the model's configuration

if TYPE_CHECKING:
    from pathlib import Path

    from spacy.language import Language

_ABSENT: Final = ("tokenizer", "vocab")
"""The tokenizer is code, and the words of the treebank are not needed for tagging."""


def load(folder: Path) -> Language:
    """Return the pipeline in `folder`, written by `save`."""
    # numpy's multiplication takes a third of the time of spaCy's own.
    with use_ops("numpy", use_blis=False):
        nlp = load_model_from_config(load_config(folder / "config.cfg"), auto_fill=False, validate=False)
    nlp.from_disk(folder, exclude=_ABSENT)
    for model in _models(nlp):
        _convert(model, "float32")
    for name in nlp.pipe_names:
        for label in getattr(nlp.get_pipe(name), "labels", ()):
            nlp.vocab.strings.add(label)
    return nlp


def save(nlp: Language, folder: Path) -> None:
    """Write a pipeline into `folder`; the numbers of `nlp` in memory are rounded too."""
    for model in _models(nlp):
        _convert(model, "float16")
    nlp.to_disk(folder, exclude=_ABSENT)
    for model in _models(nlp):
        _convert(model, "float32")


def _models(nlp: Language) -> list[Model[Any, Any]]:
    return [pipe.model for _, pipe in nlp.pipeline if hasattr(pipe, "model")]


def _convert(model: Model[Any, Any], kind: Literal["float16", "float32"]) -> None:
    for node in model.walk():
        for name in node.param_names:
            if node.has_param(name):
                numbers: Any = node.get_param(name)
                node.set_param(name, numbers.astype(kind))
