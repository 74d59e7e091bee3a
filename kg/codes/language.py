"""The codes of tagging texts: KG141 to KG144."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG141": CodeEntry(
        "pipeline not loaded",
        "spaCy cannot load the pipeline that the setting `nlp_model` names.",
        "Install the pipeline, or correct its name or path. If the setting is empty, kg uses its own pipeline.",
    ),
    "KG142": CodeEntry(
        "pipeline without tags",
        "The spaCy pipeline of the setting `nlp_model` assigns no parts of speech or no lemmas.",
        "Name a pipeline with a tagger or morphologizer and a lemmatizer, such as en_core_web_sm.",
    ),
    "KG143": CodeEntry(
        "invalid patterns",
        "The file of hardware phrase patterns is not TOML, or contains an invalid pattern.",
        "Correct the file at the place given. The head of ontology/hardware-patterns.toml describes the format.",
    ),
}
