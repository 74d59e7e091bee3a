"""The terminal interface `kg shell`: textual over `kg.query.readers` and `kg.views`, without logic of its own."""
