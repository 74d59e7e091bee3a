"""Texts to knowledge: parts of speech, lemmas, and the noun phrases that name hardware, with spaCy."""
