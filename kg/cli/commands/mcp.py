"""`kg mcp`: the server for coding assistants."""

from kg.cli.options import with_settings
from kg.errors import UsageError
from kg.settings import Settings


@with_settings("timeout", "robot", "store")
def mcp(*, settings: Settings) -> None:
    """Serve coding assistants over the Model Context Protocol.

    An assistant starts the server and talks to it on standard input and output. It can find and describe nodes, show
    how launch files wire them, what a change breaks or changed, report findings, run read-only queries and explain
    facts, each with lines of code. It can read the robot, check programs for it, and run them if a person agrees.
    Needs `pip install 'kg-ros[mcp]'`. For example, in an assistant's settings:

        {"mcpServers": {"kg": {"command": "kg", "args": ["--store", "/path/to/.kg", "mcp"]}}}
    """
    try:
        from kg.assistants.server import serve  # noqa: PLC0415 - start-up time
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != "mcp":
            raise
        hint = "pip install 'kg-ros[mcp]'"
        raise UsageError("KG555", "the SDK of the Model Context Protocol is not installed", hint=hint) from error
    serve(settings)
