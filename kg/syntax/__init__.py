"""SPARQL as text: one lexer, one tree and one parser for queries, updates and rules in every notation."""
