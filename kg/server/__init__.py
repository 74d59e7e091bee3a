"""The SPARQL endpoint and the pages: HTTP in, `kg.query.readers` and `kg.views` below; no logic of its own."""
