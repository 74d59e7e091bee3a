"""Evaluation of rules on interned terms: sorted integer arrays, joined by binary search, to a fixpoint."""
