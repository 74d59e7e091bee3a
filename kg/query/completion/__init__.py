"""Completion of queries, from the grammar and the content of the store.

    outline    parse a query, complete or broken: its triple patterns, and the tokens expected at any position
    statistics classes and properties of the store, which of them occur together, and how often; their cache
    site       a position in a query with its context: the token there, and the range that a completion replaces
    vocabulary keywords and functions of SPARQL
    terms      candidates from the store: classes of variables, properties and their values, names of graphs
    service    `complete`: collect and rank candidates

Nothing here depends on ROS: classes are found by their instances, names by their labels.
"""
