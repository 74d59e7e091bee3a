"""Tests of sentence embedding models, with a stand-in for the library."""

from __future__ import annotations

import os
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from kg.errors import UsageError
from kg.evaluate.retrieval import FolderModel

if TYPE_CHECKING:
    from pathlib import Path


def _model(folder: Path) -> Path:
    (folder / "modules.json").write_text("[]")
    return folder


def _library(monkeypatch: pytest.MonkeyPatch, encoded: Any) -> None:
    """Install a stand-in for sentence-transformers whose models return `encoded`, or raise it."""

    class Transformer:
        def __init__(self, path: str, *, local_files_only: bool) -> None:
            assert path
            assert local_files_only
            assert os.environ["HF_HUB_OFFLINE"] == "1"

        def encode(self, _: list[str], **__: object) -> Any:
            """Return what the test wants."""
            if isinstance(encoded, Exception):
                raise encoded
            return encoded

    module = ModuleType("sentence_transformers")
    module.SentenceTransformer = Transformer  # type: ignore[attr-defined]  # a module made here
    monkeypatch.setitem(sys.modules, "sentence_transformers", module)


@pytest.fixture(autouse=True)
def _switches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Restore the environment of other tests."""
    monkeypatch.setattr(os, "environ", os.environ.copy())


def test_what_is_no_model_is_refused(tmp_path: Path) -> None:
    """A name of a remote model is not downloaded, and a folder without a model reports the missing files."""
    for path, words in ((tmp_path / "all-MiniLM-L6-v2", "not a folder"), (tmp_path, "holds no model")):
        with pytest.raises(UsageError, match=words) as raised:
            FolderModel(path)
        assert raised.value.code == "KG704"
        assert raised.value.hint


def test_the_extra_is_named_where_it_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The error explains the installation; a model alone loads nothing."""
    monkeypatch.setitem(sys.modules, "sentence_transformers", None)
    model = FolderModel(_model(tmp_path))
    with pytest.raises(UsageError, match="not installed") as raised:
        model.encode(["scan"])
    assert raised.value.code == "KG704"
    assert raised.value.hint == "pip install 'kg-ros[semantic]'"


@pytest.mark.parametrize(
    ("encoded", "words"),
    [(OSError("no file named model.safetensors"), "model.safetensors"), ([[float("nan")]], "invalid numbers")],
)
def test_a_broken_model_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoded: Any, words: str) -> None:
    """The error contains the message of the library."""
    _library(monkeypatch, encoded)
    with pytest.raises(UsageError, match=words) as raised:
        FolderModel(_model(tmp_path)).encode(["scan"])
    assert raised.value.code == "KG704"


def test_vectors_have_32_bits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Vectors are arrays of 32-bit numbers, whatever the library returns."""
    _library(monkeypatch, [[0.6, 0.8]])
    assert FolderModel(_model(tmp_path)).encode(["scan"]).dtype == np.float32
