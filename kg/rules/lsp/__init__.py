"""A language server for rules: diagnostics, completion, hover, definitions (Language Server Protocol 3.17)."""
