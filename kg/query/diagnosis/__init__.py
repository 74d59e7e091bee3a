"""Diagnostics of queries, with ranges of characters and fixes.

problems   `diagnose`: errors of syntax and guards, then warnings
variables  unbound variables, unjoined patterns
fixes      edits of the text that fix a problem
"""
