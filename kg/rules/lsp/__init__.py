"""The text of a rule in an editor: diagnostics, completion, hover, definitions, references, names."""
