"""The robot behind the page `/robot`: one connection per server, its running work, and the open pages."""
