"""Scores records against truth files with a scorer that is given as a file.

The scorer is a Python file with the functions `lines`, `repo_of`, `score`, `merged`, `predicted_entries` and
`same_name`, as `score_interfaces.py` has them. Truth counts only for the sources read, at the commit read.
"""

from __future__ import annotations

import importlib.util
from collections import Counter, defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path
    from types import ModuleType

    from accuracy.reading import Reading

__all__ = [
    "INTERFACES",
    "LEVELS",
    "Record",
    "Scores",
    "in_root",
    "load_scorer",
    "score_file",
    "that_sources_hold",
    "without_command_line",
]

INTERFACES = ("publishes", "subscribes", "services", "clients", "action_servers", "action_clients")
LEVELS = ("node", "package")
Record = dict[str, Any]


@dataclass(slots=True)
class Scores:
    """Counters by category for each source that a truth file speaks of, and what was missed."""

    by_source: dict[str, dict[str, Counter[str]]] = field(default_factory=dict)
    misses: list[Record] = field(default_factory=list)

    def share(self, part: str, whole: str, categories: tuple[str, ...] | None = None) -> tuple[int, int]:
        """Return how many of `whole` are `part`, over all sources; only of the categories named."""
        total: Counter[str] = Counter()
        for counts in self.by_source.values():
            for category, counter in counts.items():
                if categories is None or category in categories:
                    total.update(counter)
        return total[part], total[whole]

    def mean(self, part: str, whole: str, categories: tuple[str, ...] | None = None) -> float | None:
        """Return the mean over sources of the share of `whole` that is `part`; None without any."""
        shares = []
        for name, counts in self.by_source.items():
            right, wanted = Scores({name: counts}).share(part, whole, categories)
            if wanted:
                shares.append(right / wanted)
        return sum(shares) / len(shares) if shares else None


def load_scorer(path: Path) -> ModuleType:
    """Return the scorer, loaded from its file."""
    spec = importlib.util.spec_from_file_location("scorer", path)
    if spec is None or spec.loader is None:
        raise SystemExit(f"{path} is no Python file")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def score_file(scorer: ModuleType, truths: list[Record], readings: list[Reading], level: str) -> Scores:
    """Return the scores of one truth file at one level, source by source."""
    scores = Scores()
    for reading in readings:
        mine = [truth for truth in truths if _speaks_of(scorer, truth, reading)]
        if not mine:
            continue
        counts, named = scorer.score(mine, reading.records, level)
        name = f"{scorer.repo_of({'repo': reading.repository.name})}@{(reading.repository.commit or '')[:7]}"
        scores.by_source[name] = dict(counts)
        scores.misses.extend({"kind": "name", **miss} for miss in named)
        scores.misses.extend(_wrong_types(scorer, mine, reading.records, level))
    return scores


def without_command_line(truth: Record) -> Record:
    """Return an observed record with the names that the node's code gives, where its start tells them.

    A node that was run with `image:=/cam/image_raw` is observed at `/cam/image_raw`; its code says `image`, and
    `camera_info` for the topic next to it. Relative names are below the namespace in which a node was started. Names
    that arguments (`relay in out`, `transform in/field`) or values of parameters (`_inputs:=[a,b]`) give are in no code
    and are left out.
    """
    arguments = truth.get("args") or ()
    pairs = [argument.split(":=", 1) for argument in arguments if ":=" in argument]
    remapped = [(old, new) for old, new in pairs if not old.startswith("_")]
    before = {"/" + new.strip("/"): old for old, new in remapped}
    before.update({_beside(new): _beside(old) for new, old in list(before.items()) if "/image" in new})
    values = [argument for argument in arguments if ":=" not in argument]
    values += [value for old, new in pairs if old.startswith("_") for value in new.strip("[]").split(",")]
    given = tuple(f"/{value.strip('/')}/" for value in values)
    namespace = (truth.get("node_name") or "").rpartition("/")[0] + "/"
    changed = dict(truth)
    for category in INTERFACES:
        entries = [dict(entry) for entry in truth.get(category) or ()]
        entries = [entry for entry in entries if not any(one.startswith(f"{entry['name']}/") for one in given)]
        for entry in entries:
            entry.setdefault("before_remap", before.get(entry["name"]))
            if entry["name"].startswith(namespace):
                entry["name"] = "/" + entry["name"].removeprefix(namespace)
        changed[category] = entries
    return changed


def in_root(reading: Reading) -> Reading:
    """Return what was read with the names that it has in the root namespace, for truth without namespaces."""
    records = [
        {**one, **{role: [_in_root(end) for end in one[role]] for role in INTERFACES}} for one in reading.records
    ]
    return replace(reading, records=records)


def _in_root(end: Record) -> Record:
    return {**end, "name": end["name"] and end["name"].replace("{namespace}/", "")}


def that_sources_hold(truth: Record) -> Record:
    """Return a record without the names that, by its own word, stand in no source, not even in part."""
    kept = {key: [one for one in truth.get(key) or () if one.get("corroborated") != "none"] for key in INTERFACES}
    return {**truth, **kept}


def _beside(image: str) -> str:
    """Return the topic of the camera information beside an image topic."""
    head, slash, _ = image.rpartition("/")
    return f"{head}{slash}camera_info"


def _speaks_of(scorer: ModuleType, truth: Record, reading: Reading) -> bool:
    commit, built = truth.get("commit"), reading.repository.commit
    same_commit = not commit or not built or commit.startswith(built) or built.startswith(commit)
    return same_commit and scorer.repo_of(truth) == scorer.repo_of({"repo": reading.repository.name})


def _wrong_types(scorer: ModuleType, truths: list[Record], records: list[Record], level: str) -> list[Record]:
    """Return the entries whose name was found and whose type was not, with the types given instead."""
    packages: dict[str, list[Record]] = defaultdict(list)
    for record in records:
        packages[record["package"]].append(record)
    misses = []
    for truth in scorer.merged(truths):
        candidates = packages[truth["package"]]
        if level == "node":
            candidates = [record for record in candidates if scorer.node_names(record) & truth["names"]]
        given = [entry for record in candidates for entry in scorer.predicted_entries(record)]
        for category, name, kind, line in truth["entries"]:
            named = [g for g in given if name and g[0] == category and scorer.same_name(name, g[1])]
            if kind and named and not any(g[2] == kind for g in named):
                misses.append(
                    {
                        "kind": "type",
                        "repo": truth.get("repo"),
                        "package": truth["package"],
                        "node": sorted(truth["names"]),
                        "category": category,
                        "name": name,
                        "type": kind,
                        "line": line,
                        "given": sorted({str(g[2]) for g in named}),
                    }
                )
    return misses
