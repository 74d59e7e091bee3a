"""Programs whose atoms are capabilities: one tree, written as JSON, as text and as blocks."""
