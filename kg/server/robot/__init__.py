"""The robot behind the page `/robot`: one connection for a server, what goes through it, and who looks on."""
