"""Launch files read without running anything, their wiring to a computation graph, and its comparison."""
