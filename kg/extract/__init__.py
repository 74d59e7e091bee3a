"""Stage 2: files become facts. Nothing here depends on RDF."""
