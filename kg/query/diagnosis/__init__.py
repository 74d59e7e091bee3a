"""What is wrong with a query, or probably is, told under the right characters and with what would mend it.

problems   `diagnose`: errors of syntax and guards, then warnings
variables  variables that nothing binds, patterns that nothing joins
fixes      edits of the text that mend a problem
"""
