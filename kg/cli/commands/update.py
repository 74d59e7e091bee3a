"""`kg update`: SPARQL updates. `kg backup` and `kg restore`: copies of the store."""

import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Final

import typer

from kg.cli.diagnostics import note, say
from kg.cli.options import Json, NoRules, argument, option, with_settings
from kg.cli.output import Column, json_lines, listing
from kg.errors import Exit, Place, UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import existing, layout_of, writable

with lazily():
    from kg.pipeline.updating.applying import apply
    from kg.pipeline.updating.changes import Update, Updated
    from kg.pipeline.updating.restoring import restore as put_back
    from kg.store.backups import back_up


Text = Annotated[str | None, argument("UPDATE", "SPARQL Update; - reads it from standard input.")]
File = Annotated[str | None, option("--file -f FILE", "Read the update from FILE.")]
DryRun = Annotated[bool, option("--dry-run", "Show what would change, without changing it.")]
Target = Annotated[str, argument("TARGET", "A new folder, or a file whose name ends in .nq or .nq.gz.")]
Source = Annotated[str, argument("BACKUP", "Folder or file written by `kg backup`.")]


@with_settings("base", "store")
def update(  # noqa: PLR0913 - the options of a command
    text: Text = None,
    *,
    settings: Settings,
    file: File = None,
    dry_run: DryRun = False,
    no_rules: NoRules = False,
    json: Json = False,
) -> None:
    """Change the store with SPARQL Update.

    Either all operations succeed or none is applied; rules then infer further facts. The prefixes of `kg query` are
    predefined. The default graph is the unnamed one. Inferred triples and the record of builds are read-only. Changes
    to what was read from a source last until the next build of that source. For example:

        kg update 'INSERT DATA { GRAPH <urn:notes> { <urn:rover> rdfs:comment "mine" } }'
        kg update -f cleaning.ru --dry-run
    """
    from kg.pipeline.updating.ownership import LEFT_OUT  # noqa: PLC0415 - start-up time

    script, place = _update_text(text, file)
    updated = apply(existing(settings), settings, Update(text=script, path=place), rules=not no_rules, dry_run=dry_run)
    show(updated, dry_run=dry_run, json=json)
    for sentence in updated.warnings:
        note(sentence)
    if any(sentence.startswith(LEFT_OUT) for sentence in updated.warnings):
        raise typer.Exit(Exit.FOUND)


@with_settings("store")
def backup(target: Target, *, settings: Settings, json: Json = False) -> None:
    """Copy the store, even while it is being written.

    A folder backup is itself a store and takes milliseconds, because large files are shared by hard links. `kg
    restore` restores it, and --store TARGET reads it. A file backup contains N-Quads whose order and blank node names
    depend only on the data. For example:

        kg backup monday
        kg backup monday.nq.gz
    """
    copied = back_up(layout_of(settings), Path(target))
    if json:
        json_lines([asdict(copied)])
    say(f"wrote {count(copied.quads, 'quad')} of snapshot {copied.snapshot} to {target}")


@with_settings("store")
def restore(source: Source, *, settings: Settings) -> None:
    """Replace the contents of the store with a backup.

    The data becomes a new snapshot; the next build reads every source again. For example:

        kg restore monday
    """
    with writable(settings) as target:
        restored = put_back(target, Path(source))
    original = f", made of snapshot {restored.original} of the backup" if restored.original else ""
    say(f"the store now holds {count(restored.quads, 'quad')}: snapshot {restored.snapshot}{original}")


def _update_text(text: str | None, file: str | None) -> tuple[str, str]:
    """Return an update and what errors call its place."""
    if (text is None) == (file is None):
        raise UsageError("KG003", "no update given", hint="See `kg update --help`.")
    if "-" in {text, file}:
        return sys.stdin.read().removeprefix("\ufeff"), "standard input"
    if text is not None:
        return text, "update"
    try:
        return Path(str(file)).read_text(encoding="utf-8-sig"), str(file)
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError("KG003", f"cannot be read: {error}", place=Place(str(file))) from error


_COLUMNS: Final = (Column("graph"), Column("removed"), Column("added"))


def show(updated: "Updated", *, dry_run: bool, json: bool) -> None:
    """Write the numbers of triples removed from and added to each graph, and the effects of rules."""
    rows = [(name or "default", removed, added) for name, (removed, added) in updated.graphs.items()]
    objects = [
        {"graph": name or None, "removed": removed, "added": added} for name, (removed, added) in updated.graphs.items()
    ]
    listing(_COLUMNS, rows, objects=objects if json else None)
    if not updated.changed:
        say("nothing changes" if dry_run else f"nothing changed; the data is snapshot {updated.snapshot}")
        return
    verb = "would change" if dry_run else "changed"
    say(f"{verb}: {count(updated.removed, 'triple')} removed, {count(updated.added, 'triple')} added")
    if updated.inferred is not None:
        say(f"rules: {updated.inferred_removed} removed, {updated.inferred_added} added ({updated.mode})")
    if not dry_run:
        say(f"the data is now snapshot {updated.snapshot}")
