"""Changes lines of the core modules and counts the changes that their tests notice.

    pip install 'mutmut>=3.8,<4'
    python benchmarks/mutation FOLDER [--modules syntax engine] [--mutants 100] [--seed 1] [--survivors FILE]

Each module is mutated by mutmut in a copy of the last commit below FOLDER. A random sample of its mutants is tried
with the tests that mutmut found to reach the changed function, in the test files named here. Texts of messages are
changed like any other value.
"""

from __future__ import annotations

import argparse
import os
import random
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Final, NamedTuple

ROOT = Path(__file__).resolve().parents[2]
_OF_QUERIES: Final = (
    "core",
    "counting",
    "formats",
    "guard",
    "levels",
    "naming",
    "runner",
    "statements",
    "stats",
    "stored",
)
"""Tests of queries in the same process. A process that a test starts does not have the mutant."""


class Module(NamedTuple):
    """Patterns of the files that are mutated, and the tests that cover them."""

    files: tuple[str, ...]
    tests: tuple[str, ...]


MODULES: Final = {
    "syntax": Module(
        ("kg/syntax/*",),
        (
            "tests/syntax",
            "tests/rules/decompose",
            "tests/rules/notations",
            "tests/rules/test_printing.py",
            "tests/rules/test_printing_round_trips.py",
            "tests/query/completion",
        ),
    ),
    "engine": Module(("kg/rules/engine/*",), ("tests/rules/engine",)),
    "symbolic": Module(
        ("kg/symbolic/values.py", "kg/symbolic/state.py", "kg/symbolic/operators.py", "kg/symbolic/containers.py"),
        ("tests/symbolic", "tests/extract/python", "tests/extract/cpp"),
    ),
    "wiring": Module(("kg/launch/wiring/*",), ("tests/launch",)),
    "query": Module(
        ("kg/query/*.py", "kg/query/readers/messages.py", "kg/query/readers/scheduler.py"),
        (
            *(f"tests/query/test_{name}.py" for name in _OF_QUERIES),
            *(f"tests/query/readers/test_{name}.py" for name in ("requests", "slots")),
            "tests/query/diagnosis",
        ),
    ),
}
_NOTICED: Final = ("killed", "timeout", "segfault")


def main() -> None:
    """Read the command line, try the mutants of each module and print a row for it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="where to put the copies, one for each module")
    parser.add_argument("--modules", nargs="+", choices=MODULES, default=list(MODULES))
    parser.add_argument("--mutants", type=int, default=100, help="size of the sample of each module")
    parser.add_argument("--seed", type=int, default=1, help="another seed gives another sample")
    parser.add_argument("--survivors", type=Path, help="write the survivors to this file, as differences")
    options = parser.parse_args()
    if len(options.modules) > 1:  # mutmut reads the settings of one folder when it is imported
        for name in options.modules:
            subprocess.run([*_command(), *_without_modules(sys.argv[1:]), "--modules", name], check=True)
        return
    (name,) = options.modules
    copy = options.folder.resolve() / name
    survivors = options.survivors and options.survivors.resolve()
    _prepare(copy, MODULES[name])
    os.chdir(copy)
    states = _try(_sample(MODULES[name], options.mutants, options.seed))
    if survivors:
        _write_differences(survivors, [one for one, state in states.items() if state not in _NOTICED])
    counts = Counter(states.values())
    noticed = sum(counts[state] for state in _NOTICED)
    others = ", ".join(f"{count} {state}" for state, count in counts.most_common())
    print(f"{name}: {len(states)} mutants, {noticed / len(states):.0%} noticed ({others})")


def _command() -> list[str]:
    return [sys.executable, str(Path(__file__).parent)]


def _without_modules(words: list[str]) -> list[str]:
    if "--modules" not in words:
        return words
    start = words.index("--modules")
    end = next((i for i in range(start + 1, len(words)) if words[i].startswith("-")), len(words))
    return words[:start] + words[end:]


def _prepare(copy: Path, module: Module) -> None:
    """Write the files of the last commit and the settings of mutmut, which has no flags for them."""
    copy.mkdir(parents=True, exist_ok=True)
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=ROOT, check=True, capture_output=True).stdout
    subprocess.run(["tar", "-x", "-C", str(copy)], input=archive, check=True)
    others = sorted(path.name for path in copy.iterdir() if path.name not in {"kg", "tests", "mutants", "setup.cfg"})
    lists = {
        "source_paths": ("kg",),
        "only_mutate": module.files,
        "also_copy": others,
        "pytest_add_cli_args_test_selection": module.tests,
        "pytest_add_cli_args": ("-p", "no:cacheprovider"),
    }
    # Forked from a process that ran no tests: threads that a test left behind would hold locks forever.
    lines = ["[mutmut]", "process_isolation = forkserver"]
    lines += [f"{key} =\n  " + "\n  ".join(values) for key, values in lists.items()]
    (copy / "setup.cfg").write_text("\n".join([*lines, ""]), encoding="utf-8")


def _sample(module: Module, size: int, seed: int) -> list[str]:
    """Return random mutants of the module, in the current folder."""
    from mutmut.mutation.file_mutation import mutate_file_contents  # noqa: PLC0415 - it reads the current folder
    from mutmut.utils.format_utils import get_mutant_name  # noqa: PLC0415 - the same

    paths = sorted({path for pattern in module.files for path in Path().glob(pattern) if path.suffix == ".py"})
    names = [
        get_mutant_name(path, name)
        for path in paths
        for name in mutate_file_contents(str(path), path.read_text(encoding="utf-8")).mutant_names
    ]
    return random.Random(seed).sample(names, min(size, len(names)))  # noqa: S311 - a sample, not a secret


def _try(names: list[str]) -> dict[str, str]:
    """Run mutmut and return the state of each mutant."""
    from mutmut.mutation.diff_apply import find_mutant  # noqa: PLC0415 - it reads the current folder
    from mutmut.stats import status_by_exit_code  # noqa: PLC0415 - the same

    program = Path(sys.executable).with_name("mutmut")
    subprocess.run([str(program), "run", *names], check=True, stdout=sys.stderr)
    return {name: status_by_exit_code[find_mutant(name).exit_code_by_key[name]] for name in names}


def _write_differences(file: Path, names: list[str]) -> None:
    from mutmut.mutation.diff_apply import get_diff_for_mutant  # noqa: PLC0415 - it reads the current folder

    with file.open("a", encoding="utf-8") as out:
        out.writelines(f"# {name}\n{get_diff_for_mutant(name)}\n" for name in sorted(names))


if __name__ == "__main__":
    main()
