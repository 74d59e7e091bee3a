"""Stage 3: facts become RDF: vocabulary, IRIs, named graphs. Independent of files."""
