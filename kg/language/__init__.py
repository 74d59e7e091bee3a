"""Language processing with spaCy: parts of speech, lemmas, and noun phrases that name hardware."""
