"""Train the pipeline that `kg` ships, from a treebank and from sentences about ROS, and write its folder.

    python benchmarks/language/train.py TREEBANK [--output FOLDER] [--epochs N]

TREEBANK holds `train.conllu.gz`, `dev.conllu.gz` and `test.conllu.gz` of UD English EWT. The state after the epoch that
does best on its development part is kept. What is trained is in `model.cfg`.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

from lemmatizing import learn
from spacy.training.initialize import init_nlp
from spacy.training.loop import train
from spacy.util import load_config, load_model
from tag_scoring import score
from treebank import read_tagged, read_treebank

import kg.language.embedding
import kg.language.tokenizer  # noqa: F401 - the configuration names these
from kg.language.lemmas import Lemmas
from kg.language.loading import SHIPPED
from kg.language.shipping import load, save

if TYPE_CHECKING:
    from spacy.language import Language

HERE: Final = Path(__file__).resolve().parent
ROOT: Final = HERE.parent.parent
TREEBANK: Final = "UD English EWT (https://github.com/UniversalDependencies/UD_English-EWT), commit 15d613d"


def main() -> None:
    """Train, write, load what was written, and print its scores."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("treebank", type=Path, metavar="TREEBANK")
    parser.add_argument("--output", type=Path, default=SHIPPED, metavar="FOLDER")
    parser.add_argument("--epochs", type=int, metavar="N", help="instead of those in model.cfg")
    parser.add_argument("--trained", type=Path, metavar="FOLDER", help="take this pipeline instead of training one")
    given = parser.parse_args()
    # Sums depend on the number of threads in their last digits.
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "BLIS_NUM_THREADS"), "1"))
    with TemporaryDirectory() as scratch:
        nlp = load_model(given.trained or trained(given.treebank, Path(scratch), given.epochs))
    lemmas = nlp.add_pipe("kg_lemmas")
    assert isinstance(lemmas, Lemmas)  # noqa: S101 - says so to the type checker
    lemmas.exceptions, lemmas.endings = learn(read_treebank(given.treebank / "train.conllu.gz"))
    describe(nlp)
    for part in ("config.cfg", "meta.json", *nlp.pipe_names):
        old = given.output / part
        shutil.rmtree(old) if old.is_dir() else old.unlink(missing_ok=True)
    save(nlp, given.output)
    scores = scores_of(load(given.output), given.treebank)
    text = json.dumps(scores, indent=1, sort_keys=True)
    (given.output / "scores.json").write_text(text + "\n", encoding="utf-8")
    print(text)


def trained(treebank: Path, folder: Path, epochs: int | None) -> Path:
    """Train and return the folder of the best state."""
    changed: dict[str, Any] = {
        "paths.treebank": str(treebank),
        "paths.sentences": str(HERE / "ros-sentences.txt"),
    }
    if epochs is not None:
        changed["training.max_epochs"] = epochs
    config = load_config(HERE / "model.cfg", overrides=changed, interpolate=True)
    train(init_nlp(config), folder)
    return folder / "model-best"


def describe(nlp: Language) -> None:
    """Write down in the pipeline's description what it is, and leave this machine's paths out of its configuration."""
    nlp.config["paths"] |= {"treebank": None, "sentences": None}
    nlp.config["corpora"] = {}
    nlp.config["nlp"]["tokenizer"] = {"@tokenizers": "kg.Tokenizer.v1"}
    nlp.meta.update(
        name="kg_ros",
        version="1.0.0",
        description="Penn tags, universal parts of speech and lemmas of English texts about robots",
        author="The kg founders",
        license="CC BY-SA 4.0",
        sources=[TREEBANK, "benchmarks/language/ros-sentences.txt"],
        performance={},
        trained_with={name: version(name) for name in ("spacy", "thinc", "numpy")}
        | {"python": platform.python_version()},
    )


def scores_of(nlp: Language, treebank: Path) -> dict[str, dict[str, float | None]]:
    """Return the scores of a pipeline on the treebank and on the sentences about ROS that the tests keep."""
    parts = {part: list(read_treebank(treebank / f"{part}.conllu.gz")) for part in ("dev", "test")}
    parts["ros"] = list(read_tagged(ROOT / "tests" / "language" / "cases" / "ros-sentences.txt"))
    found = {name: asdict(score(nlp, sentences)) for name, sentences in parts.items()}
    return {
        name: {key: value if value is None else round(value, 4) for key, value in one.items()}
        for name, one in found.items()
    }


if __name__ == "__main__":
    main()
