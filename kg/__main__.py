"""Entry point of `python -m kg`, the same as `kg`."""

from kg.cli.main import run

run()
