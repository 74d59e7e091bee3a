"""What C++ code declares: nodes, their interfaces and parameters."""
