"""Measure the tagger: accuracy on the treebank and on sentences about robots, speed, size, and what starting it costs.

python benchmarks/language TREEBANK [--model PIPELINE] [--json]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import Final

# One thread, for the figures are for one core.
os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "BLIS_NUM_THREADS"), "1"))

from tag_scoring import score, speed
from treebank import Sentence, read_tagged, read_treebank, reference

from kg.facts.places import Location
from kg.facts.texts import Description, DescriptionKind
from kg.language.annotating import annotate
from kg.language.loading import SHIPPED, pipeline

SENTENCES: Final = Path(__file__).resolve().parents[2] / "tests" / "language" / "cases" / "ros-sentences.txt"
_START: Final = """
import time
began = time.process_time()
import spacy
imported = time.process_time()
from kg.language.annotating import prepare
prepare({model!r})
print(imported - began, time.process_time() - imported)
"""


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("treebank", type=Path, metavar="TREEBANK")
    parser.add_argument("--model", default="", metavar="PIPELINE", help="instead of the shipped one")
    parser.add_argument("--json", action="store_true", help="print one object of JSON")
    given = parser.parse_args()
    parts = {part: list(read_treebank(given.treebank / f"{part}.conllu.gz")) for part in ("dev", "test")}
    parts["ros"] = list(read_tagged(SENTENCES))
    nlp = pipeline(given.model)
    scores = {name: asdict(score(nlp, sentences)) for name, sentences in parts.items()}
    texts = [reference(nlp.vocab, sentence).text for sentence in parts["test"]]
    figures = {
        "sentences a second (tagging)": round(speed(nlp, texts)),
        "sentences a second (annotate)": round(annotating(parts["test"], texts, given.model)),
        "size in bytes": sum(path.stat().st_size for path in SHIPPED.rglob("*") if path.is_file()),
        **starting(given.model),
    }
    if given.json:
        print(json.dumps({"scores": scores, "figures": figures}))
        return
    for name, one in scores.items():
        print(name, *(f"{key} {value:.4f}" for key, value in one.items() if isinstance(value, float)))
    for name, figure in figures.items():
        print(f"{name}: {figure}")


def annotating(sentences: list[Sentence], texts: list[str], model: str) -> float:
    """Return how many sentences a second of processor time get their words and phrases."""
    place = Location("README.md", 1)
    descriptions = [Description(text, DescriptionKind.README, place) for text in texts]
    annotate(descriptions[:1], model)
    began = time.process_time()
    annotate(descriptions, model)
    return len(sentences) / (time.process_time() - began)


def starting(model: str) -> dict[str, float]:
    """Return the seconds of processor time, the least of three, of importing spaCy and of loading the pipeline."""
    command = [sys.executable, "-c", _START.format(model=model)]
    runs = [subprocess.run(command, check=True, capture_output=True, text=True).stdout.split() for _ in range(3)]
    least = [min(float(run[column]) for run in runs) for column in range(2)]
    return {"import of spaCy (s)": round(least[0], 2), "loading (s)": round(least[1], 2)}


if __name__ == "__main__":
    main()
