"""Evaluation on demand: rules derive what one query needs, and nothing is written to the store.

magic      rules rewritten for the patterns of a query (magic sets)
deriving   from a query, rules and a store to the triples that the query needs
"""
