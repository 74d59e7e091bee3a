"""`kg impact`: what breaks if a name is renamed, removed or changed."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.completion import subjects
from kg.cli.drawing import Output, deliver, form_of
from kg.cli.options import Json, Markdown, argument, option, with_settings
from kg.cli.output import json_line
from kg.errors import Exit, StoreError, UsageError
from kg.lazily import lazily
from kg.settings import Settings

if TYPE_CHECKING:
    from kg.impact.model import Impact
    from kg.views.evidence import Places

with lazily():
    from kg.cli.progress import for_people
    from kg.impact.writing import (
        broken_lines,
        broken_markdown,
        broken_objects,
        impact_lines,
        impact_markdown,
        impact_object,
    )
    from kg.pipeline.revisions import commit_and_work_tree, resolve
    from kg.store.opening import existing, reading
    from kg.views.evidence import places
    from kg.views.impact import impact_of
    from kg.views.impact_changes import broken_between

Name = Annotated[
    str | None,
    argument(
        "NAME",
        "A topic, service, action, `package/Type`, `package/Type.field`, `node.parameter`, node, launch argument "
        "(`x.launch:argument`) or file.",
        autocompletion=subjects,
    ),
]
KindOf = Annotated[str | None, option("--kind -k KIND", "Kind of NAME, if it is ambiguous.")]
Diff = Annotated[
    str | None, option("--diff -d COMMIT", "Show what the work tree breaks elsewhere, compared with COMMIT.")
]
Repository = Annotated[str | None, option("--repository -C FOLDER", "Checkout for --diff; by default this folder.")]
ExitCode = Annotated[bool, option("--exit-code", "Exit with 1 if something breaks.")]


@with_settings("store")
def impact(  # noqa: PLR0913 - the options of a command
    name: Name = None,
    *,
    settings: Settings,
    diff: Diff = None,
    repository: Repository = None,
    kind: KindOf = None,
    markdown: Markdown = False,
    json: Json = False,
    output: Output = None,
    exit_code: ExitCode = False,
) -> None:
    """Show what breaks if a name is renamed, removed or changed.

    Searches code, launch files, parameter files and definitions, and shows each place with its line. `breaks` is
    certain; `may` states why it is uncertain. For example:

        kg impact /cmd_vel
        kg impact geometry_msgs/Twist.linear
        kg impact amcl.base_frame_id
        kg impact bringup.launch:use_sim_time --json
        kg impact --diff origin/main --markdown

    With --diff, each difference between COMMIT and the current files is shown with what it breaks in unchanged places.
    The store is not changed.
    """
    form = form_of({"markdown": markdown, "json": json}, output)
    if (name is None) == (diff is None):
        raise UsageError("KG003", "a name or --diff COMMIT is required", hint="`kg impact /cmd_vel`, for example.")
    if diff is not None:
        is_breaking, text = _of_commit(settings, diff, Path(repository or "."), form)
    else:
        with reading(settings) as snapshot:
            effects = impact_of(snapshot, settings, name or "", kind or "")
            is_breaking, text = effects.is_breaking, _written(effects, form, places(snapshot))
    deliver(text, form, output, "impact")
    if exit_code and is_breaking:
        raise typer.Exit(Exit.FOUND)


def _of_commit(settings: Settings, commit: str, folder: Path, form: str) -> tuple[bool, str]:
    try:
        store = existing(settings)
    except StoreError:
        if settings.store is not None:
            raise
        store = None
    revision = resolve(folder, commit)
    with for_people() as progress, commit_and_work_tree(folder, revision, store, settings, progress) as (before, after):
        broken = broken_between(before, after, settings)
    is_breaking = any(one.is_breaking for one in broken)
    if form == "json":
        return is_breaking, "".join(map(json_line, broken_objects(broken)))
    if form == "markdown":
        return is_breaking, broken_markdown(broken, f"{commit}..work tree")
    return is_breaking, "".join(f"{line}\n" for line in broken_lines(broken))


def _written(effects: "Impact", form: str, where: "Places") -> str:
    if form == "json":
        return json_line(impact_object(effects))
    if form == "markdown":
        return impact_markdown(effects, where.web)
    return "".join(f"{line}\n" for line in impact_lines(effects))
