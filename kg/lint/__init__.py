"""Findings in the wiring of systems as people get them: chosen, merged, allowed, compared with a baseline.

The rules that find them stand in `rules/architecture/`; here nothing is concluded.
"""
