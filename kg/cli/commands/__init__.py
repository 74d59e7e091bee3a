"""One module per command group; what they do lives below `kg.cli`."""
