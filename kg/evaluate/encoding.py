"""Sentence embedding models from folders, for sentence-transformers; nothing is downloaded.

The library, of the extra `semantic`, takes seconds to load, so it is loaded for the first text.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kg.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kg.search.index import Floats

_MARKS: Final = ("modules.json", "config.json")
"""Marker files of a model folder: of sentence-transformers, or of a bare transformer."""
_SWITCHES: Final = {
    "HF_HUB_OFFLINE": "1",
    "TRANSFORMERS_OFFLINE": "1",
    "HF_HUB_DISABLE_PROGRESS_BARS": "1",
    "TOKENIZERS_PARALLELISM": "false",
    "TRANSFORMERS_VERBOSITY": "error",
}
_BATCH: Final = 32
_LONGEST_CAUSE: Final = 200


class FolderModel:
    """A model in a folder.

    Raises UsageError: KG704 the folder is missing, or has no model.
    """

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            hint = "Name a folder that holds a model; kg downloads none."
            raise UsageError("KG704", f"no model at {folder}: not a folder", hint=hint)
        if not any((folder / name).is_file() for name in _MARKS):
            hint = f"A folder saved by sentence-transformers holds {_MARKS[0]}, one of transformers {_MARKS[1]}."
            raise UsageError("KG704", f"the folder {folder} holds no model", hint=hint)
        self._folder = folder
        self._model: Any = None

    def encode(self, texts: Sequence[str]) -> Floats:
        """Return a vector of length 1 for each text.

        Raises UsageError: KG704 the library is not installed, or cannot load or run the model.
        """
        try:
            if self._model is None:
                self._model = _loaded(self._folder)
            encoded = self._model.encode(
                list(texts), batch_size=_BATCH, normalize_embeddings=True, show_progress_bar=False
            )
        except UsageError:
            raise
        except Exception as problem:  # the library does not declare its exceptions for damaged files
            cause = f"{type(problem).__name__}: {' '.join(str(problem).split())[:_LONGEST_CAUSE]}"
            raise self._broken(cause) from problem
        vectors = np.asarray(encoded, np.float32)
        if vectors.shape[:1] != (len(texts),) or not np.isfinite(vectors).all():
            raise self._broken("it returned no vectors, or vectors with invalid numbers")
        return vectors

    def _broken(self, cause: str) -> UsageError:
        hint = "Copy or download the folder of the model again, or leave the model out."
        return UsageError("KG704", f"the model in {self._folder} cannot be used: {cause}", hint=hint)


def _loaded(folder: Path) -> Any:
    # The libraries read these variables once, on import.
    os.environ.update(_SWITCHES)
    try:
        library = import_module("sentence_transformers")
    except ImportError:
        message = "sentence embeddings need sentence-transformers, which is not installed"
        raise UsageError("KG704", message, hint="pip install 'kg-ros[semantic]'") from None
    return library.SentenceTransformer(str(folder), local_files_only=True)
