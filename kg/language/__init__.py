"""Texts to knowledge: parts of speech, lemmas, and the noun phrases that name hardware, with spaCy."""

from kg.language.annotating import annotate, prepare
from kg.language.loading import describe, identity

__all__ = ["annotate", "describe", "identity", "prepare"]
