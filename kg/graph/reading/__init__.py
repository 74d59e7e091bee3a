"""Readers of the graph: nodes, systems, channels and parameters as the facts that were written, and lists of them."""
