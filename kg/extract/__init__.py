"""Stage 2: files become facts. Nothing here knows of RDF."""
