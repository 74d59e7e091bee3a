"""Reporting of findings about launched systems: selection, merging, allow-list and baseline.

The rules in `rules/architecture/` infer the findings; nothing is inferred here.
"""
