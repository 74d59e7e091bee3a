"""The server for coding assistants (`kg mcp`): Model Context Protocol in, `kg.views` below; no logic of its own."""
