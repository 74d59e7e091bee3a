"""Notations of rules: each module turns what its parser gives into the internal form."""
