"""The shell on a terminal (`kg shell`): textual in, `kg.query.readers` and `kg.views` below; no logic of its own."""
