"""Runs the architecture rules over known misconfigurations, before and after they were mended, as one table.

    python benchmarks/bugs --mirrors MIRRORS [--workspaces FOLDER] [--only ID ...] [--further] [--findings FILE]

MIRRORS has a git directory for each repository of bugs.toml (`owner+name`, `owner/name`, bare or not). Each commit
becomes a workspace with a launch file that starts the whole system; `kg build` reads it, `kg lint --launch` judges it.
`--further` lists other findings of the same rules, `--findings` keeps all findings as JSON Lines. `--unpack` only makes
the workspaces.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from bugs.commands import answers, build
from bugs.facts import SIDES, Bug, read
from bugs.judging import Verdict, judge
from bugs.workspaces import MissingError, Plan, environment, make

HEAD = ("bug", "fired on the faulty", "names", "silent on the mended", "further of the rule", "peer")


def main() -> None:
    """Make the workspaces, judge them, print the table."""
    options = _options()
    bugs = [bug for bug in read() if not options.only or bug.id in options.only]
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.workspaces or Path(scratch)
        if options.unpack:
            for bug in bugs:
                print(bug.id, *(_workspace(bug, side, options.mirrors, folder) for side in SIDES))
            return
        verdicts = [verdict for bug in bugs if (verdict := _run(bug, options, folder))]
    _print(verdicts, further=options.further)


def _run(bug: Bug, options: argparse.Namespace, folder: Path) -> Verdict | None:
    try:
        sides = {side: _findings(bug, side, options.mirrors, folder) for side in SIDES}
    except MissingError as missing:
        print(f"{bug.id}: {missing}", file=sys.stderr)
        return None
    if options.findings:
        _keep(options.findings, bug, sides)
    return judge(bug, sides["faulty"], sides["fixed"])


def _findings(bug: Bug, side: str, mirrors: Path, folder: Path) -> list[dict[str, Any]]:
    launch = _workspace(bug, side, mirrors, folder)
    workspace, store = folder / bug.id / side, folder / bug.id / f"{side}.kg"
    build(workspace, store)
    return answers("lint", launch, store, environment(bug.environment))


def _workspace(bug: Bug, side: str, mirrors: Path, folder: Path) -> Path:
    plan = Plan(
        [(tree.repository, tree.folder, tree.commits[side]) for tree in bug.trees],
        [(start.file, start.arguments[side]) for start in bug.starts],
        bug.nodes,
        bug.beside,
    )
    return make(plan, mirrors, folder / bug.id / side)


def _keep(path: Path, bug: Bug, sides: dict[str, list[dict[str, Any]]]) -> None:
    with path.open("a") as stream:
        for side, findings in sides.items():
            stream.writelines(json.dumps({"bug": bug.id, "side": side, **one}) + "\n" for one in findings)


def _print(verdicts: list[Verdict], *, further: bool) -> None:
    print(f"| {' | '.join(HEAD)} |\n|{'---|' * len(HEAD)}")
    for verdict in verdicts:
        print(f"| {' | '.join(_row(verdict))} |")
    peer = sum(verdict.bug.peer == "found" for verdict in verdicts)
    print(f"\n{sum(verdict.found for verdict in verdicts)} of {len(verdicts)} found; the peer {peer}")
    if further:
        for verdict in verdicts:
            for one in verdict.further:
                print(f"{verdict.bug.id}: {one['code']} {one.get('message', '')}")


def _row(verdict: Verdict) -> tuple[str, ...]:
    return (
        verdict.bug.id,
        ", ".join(verdict.codes) or "no",
        f"{verdict.named}/{len(verdict.bug.names)}",
        "yes" if verdict.silent else "no",
        str(len(verdict.further)),
        verdict.bug.peer,
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mirrors", type=Path, required=True, help="folder with the git directories")
    parser.add_argument(
        "--workspaces", type=Path, help="where to make the workspaces; by default a folder that is removed"
    )
    parser.add_argument("--only", nargs="+", default=[], metavar="ID", help="only these bugs")
    parser.add_argument("--further", action="store_true", help="list other findings of the rules that fired")
    parser.add_argument("--findings", type=Path, help="file to add all findings to, as JSON Lines")
    parser.add_argument("--unpack", action="store_true", help="only make the workspaces")
    return parser.parse_args()


if __name__ == "__main__":
    main()
