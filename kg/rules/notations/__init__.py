"""Notations of rules: each module turns its parser's result into the internal form."""
