"""What Python code declares: nodes, their interfaces and parameters."""
