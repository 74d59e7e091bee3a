"""One module for each command, or for a few related ones; larger views of results are in `kg.cli`."""
