from __future__ import annotations

import os
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any, Final
from zlib import crc32

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from search.store import CONTENT

from kg.errors import UsageError
from kg.search.encoding import FolderModel
from kg.search.index import build
from kg.search.meaning import Meaning, told
from kg.search.needs import Need
from kg.search.ranking import scores
from kg.search.reading import Content
from kg.search.searching import Search, hit_object

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kg.search.index import Floats

INDEX: Final = build(CONTENT)
NEED: Final = "merge the scans of two lasers into one"
STRANGE: Final = "zusammenlegen"
"""A word that no node has: only meaning finds something for it."""
_WIDE: Final = 16


class Stand:
    """An encoder whose vectors come from hashes of words, and that remembers what it was asked for."""

    def __init__(self, identity: str = "stand", same: dict[str, str] | None = None) -> None:
        self.identity = identity
        self.same = same or {}
        self.asked: list[str] = []

    def encode(self, texts: Sequence[str]) -> Floats:
        """Return the sum of a vector of each word, of length 1."""
        self.asked += texts
        rows = []
        for text in texts:
            words = [self.same.get(word, word) for word in text.lower().replace(",", " ").split()]
            row = sum(np.random.default_rng(crc32(word.encode())).standard_normal(_WIDE) for word in words)
            rows.append(row / np.linalg.norm(row))
        return np.array(rows, np.float32)


def test_texts_are_embedded_once(tmp_path: Path) -> None:
    """What was embedded is kept beside the index; the next process embeds the need alone, and finds the same."""
    first, second = Stand(), Stand()
    before = Meaning(tmp_path, INDEX, first).likeness(NEED)
    after = Meaning(tmp_path, INDEX, second)
    assert after.unknown() == 0
    assert np.array_equal(after.likeness(NEED), before)
    assert second.asked == [NEED]
    # The copy of a node in another package of the same name has its own text, for that package has no description.
    assert len(first.asked) == INDEX.size + 1
    assert [path.name for path in (tmp_path / "search" / "vectors").iterdir()] == ["stand"]


def test_only_texts_that_changed_are_embedded_anew(tmp_path: Path) -> None:
    """A new description costs one text; vectors of texts that are gone go."""
    Meaning(tmp_path, INDEX, Stand()).likeness(NEED)
    nodes = list(CONTENT.nodes)
    nodes[3] = msgspec.structs.replace(nodes[3], name="webcam_driver")
    changed = build(Content(CONTENT.packages, nodes, CONTENT.concepts))
    encoder = Stand()
    meaning = Meaning(tmp_path, changed, encoder)
    assert meaning.unknown() == 1
    meaning.likeness(NEED)
    assert encoder.asked == [told(nodes[3], CONTENT.packages[1]), NEED]
    assert Meaning(tmp_path, INDEX, Stand()).unknown() == 1


def test_another_model_shares_no_vectors(tmp_path: Path) -> None:
    """Vectors are of one model, and those of the model before are removed."""
    Meaning(tmp_path, INDEX, Stand("one")).likeness(NEED)
    other = Meaning(tmp_path, INDEX, Stand("two"))
    assert other.unknown() == INDEX.size
    other.likeness(NEED)
    assert [path.name for path in (tmp_path / "search" / "vectors").iterdir()] == ["two"]


@given(st.data())
@settings(max_examples=40)
def test_damaged_vectors_are_made_again(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """Bytes that changed, or are missing, are noticed, and no byte of them is believed."""
    folder = tmp_path_factory.mktemp("cache")
    expected = Meaning(folder, INDEX, Stand()).likeness(NEED)
    file = folder / "search" / "vectors" / "stand"
    content = bytearray(file.read_bytes())
    place = data.draw(st.integers(0, len(content) - 1))
    if data.draw(st.booleans()):
        content[place] ^= data.draw(st.integers(1, 255))
    else:
        del content[place:]
    file.write_bytes(content)
    meaning = Meaning(folder, INDEX, Stand())
    assert meaning.unknown() == INDEX.size
    assert np.array_equal(meaning.likeness(NEED), expected)


def test_without_a_model_nothing_changes(tmp_path: Path) -> None:
    """Scores without likeness, and with a likeness of nothing, are the same to the bit."""
    need = Search(INDEX).find(NEED).need
    assert isinstance(need, Need)
    without = scores(INDEX, need)
    assert np.array_equal(without, scores(INDEX, need, np.zeros(INDEX.size, np.float32)))
    answer = [hit_object(hit) for hit in Search(INDEX).find(NEED).hits]
    assert not any("meaning" in text for hit in answer for text in hit["why"])
    Search(INDEX, Meaning(tmp_path, INDEX, Stand())).find(NEED)
    assert [hit_object(hit) for hit in Search(INDEX).find(NEED).hits] == answer


def test_meaning_finds_what_words_do_not(tmp_path: Path) -> None:
    """A node that is like the need in meaning is a hit, and says so."""
    assert not Search(INDEX).find(STRANGE).hits
    search = Search(INDEX, Meaning(tmp_path, INDEX, Stand(same={STRANGE: "camera"})))
    first = search.find(STRANGE).hits[0]
    assert first.name == "camera_driver"
    assert "is like it in meaning" in [str(one) for one in first.why]


def test_filters_alone_need_no_model(tmp_path: Path) -> None:
    """Nothing is embedded where there are no words; filters leave out what is like the need but lacks them."""
    encoder = Stand(same={STRANGE: "camera"})
    search = Search(INDEX, Meaning(tmp_path, INDEX, encoder))
    search.find("", {"subscribes": ["LaserScan"]})
    assert encoder.asked == []
    assert "camera_driver" not in [hit.name for hit in search.find(STRANGE, {"subscribes": ["LaserScan"]}).hits]


def test_a_store_that_may_only_be_read_is_searched_too(tmp_path: Path) -> None:
    """Vectors that cannot be kept serve the search that made them."""
    (tmp_path / "search").write_text("a file where the folder would be")
    assert len(Meaning(tmp_path, INDEX, Stand()).likeness(NEED)) == INDEX.size


def test_an_empty_store_has_nothing_to_embed(tmp_path: Path) -> None:
    """Without nodes no model is loaded."""
    encoder = Stand()
    assert not Meaning(tmp_path, build(Content([], [], [])), encoder).likeness(NEED).size
    assert encoder.asked == []


def _model(folder: Path) -> Path:
    (folder / "modules.json").write_text("[]")
    return folder


def _library(monkeypatch: pytest.MonkeyPatch, encoded: Any) -> None:
    """Put a module in place of sentence-transformers whose models give `encoded`, or raise it."""

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
    """Leave the environment of other tests as it was."""
    monkeypatch.setattr(os, "environ", os.environ.copy())


def test_what_is_no_model_is_refused(tmp_path: Path) -> None:
    """The name of a model elsewhere is not downloaded, and a folder without a model says what is missing."""
    for path, words in ((tmp_path / "all-MiniLM-L6-v2", "not a folder"), (tmp_path, "holds no model")):
        with pytest.raises(UsageError, match=words) as raised:
            FolderModel(path)
        assert raised.value.code == "KG704"
        assert raised.value.hint


def test_the_extra_is_named_where_it_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The error says how to install it; a model alone loads nothing."""
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
    """What the library says stands in the error."""
    _library(monkeypatch, encoded)
    with pytest.raises(UsageError, match=words) as raised:
        FolderModel(_model(tmp_path)).encode(["scan"])
    assert raised.value.code == "KG704"


def test_a_model_is_known_by_its_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its identity changes with a file; its vectors are numbers of 32 bits."""
    _library(monkeypatch, [[0.6, 0.8]])
    model = FolderModel(_model(tmp_path))
    assert model.encode(["scan"]).dtype == np.float32
    assert FolderModel(tmp_path).identity == model.identity
    (tmp_path / "weights").write_bytes(b"1")
    assert FolderModel(tmp_path).identity != model.identity
