"""Stage 3: facts become RDF: vocabulary, IRIs, named graphs. Nothing here knows of files."""
