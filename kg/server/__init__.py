"""The SPARQL endpoint and the web pages: HTTP over `kg.query.readers` and `kg.views`, without logic of its own."""
