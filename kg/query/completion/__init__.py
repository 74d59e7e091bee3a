"""Completion of queries, from the grammar and the content of the store.

    outline    parse a query, complete or broken: its triple patterns, and the tokens expected at any position
    typed      the token at a position, and the range of the text that a completion replaces
    statistics classes and properties of the store, which of them occur together, and how often
    keeping    cache of the statistics
    names      values of properties, and names of graphs
    meaning    possible classes of the variables of a query
    site       a position in a query with its context
    vocabulary keywords and functions of SPARQL
    terms      candidates from the store
    service    `complete`: collect and rank candidates

Nothing here depends on ROS: classes are found by their instances, names by their labels.
"""
