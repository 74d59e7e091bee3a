"""Builds the computation graph from a launch configuration and the declarations of node types; nothing is run."""
