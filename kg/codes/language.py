"""The codes of tagging texts: KG141 to KG144."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG141": CodeEntry(
        "pipeline not loaded",
        "spaCy cannot load the pipeline that the setting `nlp_model` names.",
        "Install it, mend the name or path, or leave the setting empty: kg has a pipeline of its own.",
    ),
    "KG142": CodeEntry(
        "pipeline without tags",
        "The spaCy pipeline that the setting `nlp_model` names sets no parts of speech, or no lemmas.",
        "Name one with a tagger or morphologizer and a lemmatizer, as en_core_web_sm is.",
    ),
    "KG143": CodeEntry(
        "patterns not usable",
        "The file of patterns that find phrases of hardware is not TOML, or a pattern in it is none.",
        "Mend the file at the place named; the head of ontology/hardware-patterns.toml says what may stand in it.",
    ),
}
