"""`kg publish` and `kg pull`: graphs for others, and those of others."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from kg.cli.diagnostics import note, say
from kg.cli.options import Json, with_settings
from kg.cli.output import json_lines
from kg.errors import UsageError
from kg.forms import FormError, size
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import existing, writable

with lazily():
    from kg.pipeline.snapshots import publish as write
    from kg.pipeline.snapshots import pull as fetch
    from kg.rules.folders import user_folders
    from kg.search.searching import open_search

Target = Annotated[
    str, typer.Argument(metavar="TARGET", help="A folder, or an address of a web server that accepts PUT.")
]
Address = Annotated[
    str, typer.Argument(metavar="ADDRESS", help="What `kg publish` wrote: http(s)://, file:// or a folder.")
]
NoIndex = Annotated[bool, typer.Option("--no-index", help="Leave out the search index.")]
WithIndex = Annotated[
    bool,
    typer.Option("--index", help="Also take the publisher's search index; by default the first search builds one."),
]
MaxBytes = Annotated[
    str, typer.Option("--max-bytes", metavar="SIZE", help="Refuse a snapshot larger than this, packed or unpacked.")
]


@with_settings("rules", "base", "store")
def publish(
    target: Target,
    *,
    settings: Settings,
    no_index: NoIndex = False,
    json: Json = False,
) -> None:
    """Write the graph for others, to a folder or a web server.

    Writes the graph as compressed N-Quads, the search index, your own rules, and a manifest with the digest of each.
    What was published there before is replaced. The graph names the folders of its sources on this machine. A web
    server gets the credentials in KG_REMOTE_TOKEN, or KG_REMOTE_USER and KG_REMOTE_PASSWORD. For example:

        kg publish /srv/www/robots
        kg publish https://files.example.org/robots
    """
    opened = existing(settings)
    if not no_index:
        open_search(opened)
    with opened.read() as snapshot:
        index = None if no_index else opened.layout.cache / "search" / snapshot.identity
        manifest = write(snapshot, target, settings.base, user_folders(settings), index)
    if json:
        json_lines([asdict(manifest)])
    say(f"published {count(manifest.quads, 'quad')} with digest {manifest.digest} to {target}")


@with_settings("store")
def pull(
    address: Address,
    *,
    settings: Settings,
    index: WithIndex = False,
    max_bytes: MaxBytes = "4G",
    json: Json = False,
) -> None:
    """Fetch a published graph and make a store of it.

    Every file is compared with its digest, and the store is unchanged unless all are whole. Pulling again replaces the
    content. Rules of the publisher are kept in STORE/published/rules and are not run unless you name them with --rules.
    A web server gets the credentials in KG_REMOTE_TOKEN, or KG_REMOTE_USER and KG_REMOTE_PASSWORD. For example:

        kg pull https://files.example.org/robots --store robots
        kg query --store robots --store .kg 'SELECT ?node { ?node a ros:Node }'
    """
    try:
        limit = size(max_bytes, Path())
    except FormError as error:
        raise UsageError("KG002", f"--max-bytes is {max_bytes!r}, which is not {error}") from error
    with writable(settings) as target:
        manifest = fetch(address, target, limit, with_index=index)
    if json:
        json_lines([asdict(manifest)])
    say(f"pulled {count(manifest.quads, 'quad')} with digest {manifest.digest} into {target.layout.root}")
    if manifest.rules:
        rules = target.layout.root / "published" / "rules"
        note(f"{count(len(manifest.rules), 'rule')} of the publisher in {rules}; `--rules` runs them")
