"""Diagnostics of queries, with ranges of characters and fixes.

problems   `diagnose`: errors of syntax and guards, then warnings; edits of the text that fix them
variables  unbound variables, unjoined patterns
"""
