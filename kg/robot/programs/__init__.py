"""Programs of capabilities: one tree, written as JSON, as text or as blocks."""
