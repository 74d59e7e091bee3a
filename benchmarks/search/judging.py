"""NDCG of the search on judged needs, beside plain BM25, and with weights chosen inside the folds."""

from __future__ import annotations

import hashlib
import json
from itertools import product
from statistics import mean
from typing import TYPE_CHECKING, Any, Final

import bm25s

from kg.evaluate.retrieval import Ranked, ndcg, read_needs, text_of_node
from kg.search.searching import Hit, Search
from kg.search.words import lexicon

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.evaluate.retrieval import Need

__all__ = ["judge"]

DEPTHS: Final = (1, 5)
FOLDS: Final = 5
GRID: Final = {
    ("rank", "named"): (0.1, 0.2),
    ("rank", "synonym"): (0.6, 0.8),
    ("rank", "everyday"): (0.6, 0.8),
    ("rank", "started"): (0.0, 0.2),
    ("rank", "aside"): (0.25, 1.0),
    ("rank", "alike"): (0.0, 0.1),
    ("down", "mark"): (0.0, 0.2),
    ("down", "test"): (0.0, 0.5),
}
"""The weights that are tried; those that ship are of this grid."""
LEASTS: Final = tuple(step / 100 for step in range(2, 31))
"""The thresholds that are tried for saying that nothing fits."""


def judge(search: Search, files: Sequence[Path], *, fit: bool) -> None:
    """Print the scores of each file; needs without a right answer are scored apart."""
    sets = {file.stem: read_needs(file) for file in files}
    nothing = {need.id for needs in sets.values() for need in needs if not any(one.grade for one in need.relevant)}
    answered = {name: tuple(need for need in needs if need.id not in nothing) for name, needs in sets.items()}
    plain = _Plain(search)
    for name, needs in answered.items():
        for label, found in (
            ("kg", [_found(search, need) for need in needs]),
            ("plain BM25", list(map(plain.found, needs))),
        ):
            print(f"{name}, {label}: {_figures(list(zip(needs, found, strict=True)))}")
    for name, needs in sets.items():
        said = [need.id for need in needs if not search.find(need.query, limit=3).fits]
        right = len([one for one in said if one in nothing])
        total = len([need for need in needs if need.id in nothing])
        print(
            f"{name}: nothing fits said for {right} of {total} such needs, "
            f"{len(said) - right} of {len(needs) - total} others"
        )
    if fit:
        _cross_validated(search, answered, sets, nothing)


def _found(search: Search, need: Need) -> list[Ranked]:
    hits = search.find(need.query, limit=max(DEPTHS)).hits
    return [Ranked(hit.package.repository, hit.package.name, hit.name) for hit in hits]


def _figures(pairs: Sequence[tuple[Need, Sequence[Ranked]]]) -> str:
    values = (mean(ndcg(need, found, depth) for need, found in pairs) for depth in DEPTHS)
    return f"{len(pairs)} needs, NDCG@1 / NDCG@5 {' / '.join(f'{value:.3f}' for value in values)}"


class _Plain:
    """BM25 as bm25s has it unless told, over all words of a node and its package; copies and variants are one."""

    def __init__(self, search: Search) -> None:
        self.index = search.index
        nodes = map(self.index.nodes.__getitem__, range(self.index.size))
        texts = [text_of_node(node, self.index.packages[node.package]) for node in nodes]
        self.engine = bm25s.BM25()
        self.engine.index(bm25s.tokenize(texts, stopwords="en", show_progress=False), show_progress=False)

    def found(self, need: Need) -> list[Ranked]:
        """Return the best nodes for a need."""
        words = bm25s.tokenize(need.query, stopwords="en", show_progress=False)
        places, _ = self.engine.retrieve(words, k=min(50, self.index.size), show_progress=False)
        chosen: dict[int, Hit] = {}
        for place in places[0].tolist():
            node = self.index.nodes[place]
            chosen.setdefault(
                int(self.index.group[place]), Hit(0, 0.0, node, self.index.packages[node.package], (), ())
            )
        return [Ranked(hit.package.repository, hit.package.name, hit.name) for hit in chosen.values()][: max(DEPTHS)]


def _cross_validated(
    search: Search, sets: Mapping[str, Sequence[Need]], all_needs: Mapping[str, Sequence[Need]], nothing: set[str]
) -> None:
    """Print the scores of held-out needs; a need is in one fold, whatever its wording."""
    choices = list(_choices())
    scored = [
        {
            (name, need.id): [ndcg(need, _found(search, need), depth) for depth in DEPTHS]
            for name, needs in sets.items()
            for need in needs
        }
        for _ in _applied(choices)
    ]
    held: dict[str, list[list[float]]] = {name: [] for name in sets}
    for fold in range(FOLDS):
        training = [key for key in scored[0] if _fold(key[1]) != fold]
        best = max(range(len(choices)), key=lambda at: mean(mean(scored[at][key]) for key in training))
        for key in scored[0]:
            if _fold(key[1]) == fold:
                held[key[0]].append(scored[best][key])
        print(f"fold {fold}: {json.dumps({name: value for (_, name), value in choices[best].items()})}")
    for name, values in held.items():
        means = " / ".join(f"{mean(value):.3f}" for value in zip(*values, strict=True))
        print(f"{name}, held out: NDCG@1 / NDCG@5 {means}")
    _thresholds(search, all_needs, nothing)


def _choices() -> Iterator[dict[tuple[str, str], float]]:
    for values in product(*GRID.values()):
        yield dict(zip(GRID, values, strict=True))


def _applied(choices: Sequence[dict[tuple[str, str], float]]) -> Iterator[None]:
    """Put the weights of each choice in force, one after another, and then those that were."""
    tables: Any = lexicon().weights
    before = {(table, name): tables[table][name] for table, name in GRID}
    for choice in (*choices, before):
        for (table, name), value in choice.items():
            tables[table][name] = value
        if choice is not before:
            yield


def _fold(name: str) -> int:
    return int.from_bytes(hashlib.blake2b(name.encode(), digest_size=4).digest(), "big") % FOLDS


def _thresholds(search: Search, sets: Mapping[str, Sequence[Need]], nothing: set[str]) -> None:
    """Print how often held-out needs are said to fit nothing, with the threshold chosen by the other needs."""
    weights: Any = lexicon().weights["rank"]
    before = weights["least"]
    needs = [(name, need) for name, found in sets.items() for need in found]
    said = {}
    for least in LEASTS:
        weights["least"] = least
        said[least] = {(name, need.id): not search.find(need.query, limit=3).fits for name, need in needs}
    weights["least"] = before
    counts: dict[tuple[str, bool], list[bool]] = {}
    for fold in range(FOLDS):
        training = [(name, need.id) for name, need in needs if _fold(need.id) != fold]
        least = max(LEASTS, key=lambda one: _balanced(said[one], training, nothing))
        for name, need in needs:
            if _fold(need.id) == fold:
                counts.setdefault((name, need.id in nothing), []).append(said[least][name, need.id])
        print(f"fold {fold}: threshold {least}")
    for (name, is_nothing), values in counts.items():
        print(
            f"{name}, held out: nothing fits said for {sum(values)} of {len(values)} "
            f"{'such needs' if is_nothing else 'others'}"
        )


def _balanced(said: dict[tuple[str, str], bool], keys: Sequence[tuple[str, str]], nothing: set[str]) -> float:
    right = [said[key] for key in keys if key[1] in nothing]
    wrong = [said[key] for key in keys if key[1] not in nothing]
    return mean(right) - 3 * mean(wrong) if right else -mean(wrong)
