"""Builds on a cluster of this machine: equality with workers killed, overhead, memory.

    python benchmarks/cluster equality [--rounds 20] [--copies 10] [--fetch]
    python benchmarks/cluster overhead CHECKOUT [--copies 1 2] [--repeat 3]
    python benchmarks/cluster memory CHECKOUT... [--copies 10 77 300]
    python benchmarks/cluster writer CHECKOUT... [--copies 10 77 300]
    python benchmarks/cluster rules STORE [--parts 1 2 4]

`rules` compares one process with processes that run the local rules of parts of a store (`dividing.py`).
Repositories are copies of the checkouts, by default of the example workspace, with other names of packages.
`writer` measures the process that writes, with all packages read before.
Times are of processors, summed over all processes; memory is the proportional size of a process, at its peak. Of the
process that writes, the anonymous part is given too: the rest are pages of files, which the system can drop.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from cluster.dividing import compare

from kg.corpus.fetching.many import fetch
from kg.corpus.fetching.one import Options
from kg.corpus.fetching.wanted import wanted_among
from kg.corpus.files import Pin
from kg.pipeline.build import build
from kg.pipeline.report import Report
from kg.settings import load
from kg.store.backups import canonical
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.fetching.lock import Entry

_EXAMPLES: Final = Path(__file__).resolve().parents[2] / "examples" / "workspace"
_PAUSE_SECONDS: Final = 0.05
_MANIFEST_NAME: Final = re.compile(r"<name>\s*([\w-]+)\s*</name>")
_TICKS: Final = os.sysconf("SC_CLK_TCK")
_READER: Final = b"kg.pipeline.extracting"
_KILL_WITHIN: Final = 0.7
"""Seconds; reading ten small repositories takes about as long."""


def main() -> None:
    """Read the command line and print a table in Markdown."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("what", choices=["equality", "overhead", "memory", "writer", "rules"])
    parser.add_argument("checkouts", nargs="*", type=Path, default=[_EXAMPLES / "rover", _EXAMPLES / "drone"])
    parser.add_argument("--copies", type=int, nargs="+")
    parser.add_argument("--parts", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--fetch", action="store_true", help="workers fetch the repositories, in each round anew")
    parser.add_argument("--repeat", type=int, default=3, help="builds of each kind, of which the cheapest counts")
    options = parser.parse_args()
    if options.what == "rules":
        compare(options.checkouts[0], options.parts)
        return
    with tempfile.TemporaryDirectory(prefix="kg-cluster-") as folder:
        if options.what == "equality":
            _equality(
                Path(folder), options.checkouts, (options.copies or [10])[0], options.rounds, by_workers=options.fetch
            )
        elif options.what == "overhead":
            _overhead(Path(folder), options.checkouts, options.copies or [1, 2], options.repeat)
        elif options.what == "writer":
            _writer(Path(folder), options.checkouts, options.copies or [10, 77, 300])
        else:
            _memory(Path(folder), options.checkouts, options.copies or [10, 77, 300])


def _repositories(folder: Path, checkouts: list[Path], number: int) -> list[str]:
    """Write `number` repositories and return their folders: copies of the checkouts in turn, under other names."""
    found = []
    for index in range(number):
        original = checkouts[index % len(checkouts)]
        target = folder / f"{original.name}_{index}"
        if not target.exists():
            shutil.copytree(original, target, ignore=shutil.ignore_patterns(".git"), symlinks=True)
            _rename(target, index)
        found.append(str(target))
    return found


def _rename(folder: Path, index: int) -> None:
    """Give all packages of a copy other names, in the texts of its files, and so to folders with their names."""
    manifests = [path.read_text(errors="replace") for path in folder.rglob("package.xml")]
    names = {match[1] for text in manifests if (match := _MANIFEST_NAME.search(text))}
    words = re.compile(r"\b(" + "|".join(sorted(map(re.escape, names), key=len, reverse=True)) + r")\b")
    for path in folder.rglob("*"):
        if path.is_file() and not path.is_symlink():
            with suppress(UnicodeDecodeError):
                text = path.read_text()
                path.write_text(words.sub(rf"\1_{index}", text))
    folders = [path for path in folder.rglob("*") if path.is_dir() and not path.is_symlink() and path.name in names]
    for path in sorted(folders, key=lambda one: -len(one.parts)):
        path.rename(path.with_name(f"{path.name}_{index}"))


def _digest(store: EmbeddedStore) -> str:
    """Return what stands for all quads but the record of builds, which has times."""
    with store.read() as snapshot:
        lines = canonical(quad for quad in snapshot.quads() if not str(quad.graph_name).endswith("graph/builds>"))
    return hashlib.blake2b(b"".join(lines), digest_size=16).hexdigest()


class _Killer(Report):
    """Kills one process of the cluster at a random moment after the first worker has begun."""

    def __init__(self, generator: random.Random) -> None:
        self.killed = 0
        self._generator = generator
        self._timer: threading.Timer | None = None

    def placed(self, worker: str, source: str) -> None:  # noqa: ARG002 - any of them
        """Begin to wait."""
        self.fetching("")

    def fetching(self, message: str) -> None:  # noqa: ARG002 - any of them
        """Begin to wait."""
        if self._timer is None:
            self._timer = threading.Timer(self._generator.uniform(0, _KILL_WITHIN), self._kill)
            self._timer.start()

    def _kill(self) -> None:
        below = [process for process in _descendants(os.getpid()) if _is_worker(process)]
        if below:
            with suppress(ProcessLookupError):
                os.kill(self._generator.choice(below), signal.SIGKILL)
                self.killed += 1

    def end(self) -> None:
        """Kill nothing any more."""
        if self._timer:
            self._timer.cancel()
            self._timer.join()


class _NoReport:
    """Receives the progress of fetching."""

    def begin(self, repositories: int) -> None:
        """Ignore it."""

    def ended(self, entry: Entry) -> None:
        """Ignore it."""


def _fetched(folder: Path, named: list[str]) -> dict[str, Pin]:
    """Commit the content of folders, fetch these repositories, and return the pins of the checkouts."""
    identity = ("-c", "user.name=A", "-c", "user.email=a@example.org")
    for one in named:
        for arguments in (("init", "--quiet"), ("add", "--all"), (*identity, "commit", "--quiet", "--message=A")):
            subprocess.run(("git", "-C", one, *arguments), check=True)
    lock = folder / "corpus" / "corpus.lock.toml"
    found = fetch(wanted_among(Path(one).as_uri() for one in named), lock.parent, lock, Options(), _NoReport())
    return {str(found.lock.folder(one)): Pin(one.name, one.url, one.commit) for one in found.entries}


def _equality(folder: Path, checkouts: list[Path], number: int, rounds: int, *, by_workers: bool) -> None:
    from distributed import LocalCluster  # noqa: PLC0415 - for this measurement alone

    generator = random.Random(1)  # noqa: S311 - no secret
    named = _repositories(folder / "src", checkouts, number)
    pins = _fetched(folder, named) if by_workers else {}
    named = [*pins] or named
    alone = EmbeddedStore.create(folder / "alone")
    build(named, alone, load({}, environment={}))
    wanted, equal, killed = _digest(alone), 0, 0
    if pins:
        (folder / "corpus" / "local").rename(folder / "checkouts")
    os.environ["XDG_CACHE_HOME"] = str(folder / "cache")
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=50) as cluster:
        for round_number in range(rounds):
            store, artifacts = folder / f"store{round_number}", folder / f"artifacts{round_number}"
            given = {"cluster": cluster.scheduler_address, "artifacts": str(artifacts)}
            report = _Killer(generator)
            generator.shuffle(named)
            unfetched = build(
                named, EmbeddedStore.create(store), load(given, environment={}), report, pins=pins
            ).unfetched
            report.end()
            for one in unfetched:
                print(f"round {round_number}: {one.name} {one.state}: {one.reason}")
            killed += report.killed
            equal += _digest(EmbeddedStore.create(store)) == wanted
            shutil.rmtree(store)
            shutil.rmtree(artifacts)
            shutil.rmtree(folder / "cache", ignore_errors=True)
    print(f"equal in {equal} of {rounds} rounds, {killed} processes killed; {number} repositories")


@dataclass
class _Use:
    """What a command used, by role of the process: processor seconds, and the largest peaks in megabytes."""

    seconds: dict[str, float] = field(default_factory=dict)
    peaks: dict[str, float] = field(default_factory=dict)
    own: dict[str, float] = field(default_factory=dict)
    """The same of anonymous memory, which belongs to no file."""


def _measured(*arguments: str) -> _Use:
    """Run `kg` and look at it and all that it starts, until it ends."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
    command = [sys.executable, "-m", "kg", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment)
    said = threading.Thread(target=process.stderr.read if process.stderr else print)
    said.start()
    spent: dict[int, float] = {}
    roles: dict[int, str] = {}
    use = _Use()
    while process.poll() is None:
        readers: dict[int, float] = {}
        for one in [process.pid, *_descendants(process.pid)]:
            # A process that has ended has no command any more.
            role = roles.setdefault(one, "build" if one == process.pid else "other")
            if role == "other" and _READER in _file(one, "cmdline"):
                role = roles[one] = "reader"
            spent[one] = max(spent.get(one, 0.0), _processor_seconds(one))
            size, own = _megabytes(one)
            if role == "reader":  # with the fork of it that reads
                parent = int((_fields(one) or [b"", b"0"])[1])
                group = parent if parent in readers else one
                size = readers[group] = readers.get(group, 0.0) + size
            use.peaks[role] = max(use.peaks.get(role, 0.0), size)
            use.own[role] = max(use.own.get(role, 0.0), own)
        time.sleep(_PAUSE_SECONDS)
    said.join()
    if process.returncode:
        raise SystemExit(f"{' '.join(command)} ended with {process.returncode}")
    for one, seconds in spent.items():
        use.seconds[roles[one]] = use.seconds.get(roles[one], 0.0) + seconds
    return use


def _words(seconds: dict[str, float]) -> str:
    parts = ", ".join(f"{role} {one:.1f}" for role, one in seconds.items())
    return f"{sum(seconds.values()):.1f} ({parts})"


def _overhead(folder: Path, checkouts: list[Path], copies: list[int], repeat: int) -> None:
    print("| repositories | processor seconds, one machine | on a cluster of two workers |\n|---|---|---|")
    points = []
    for number in copies:
        named = _repositories(folder / "src", checkouts, number)
        ways = (("--jobs", "2"), ("--cluster", "local:2", "--artifacts", str(folder / "artifacts")))
        alone, many = (min(_builds(folder, named, way, repeat), key=lambda one: sum(one.values())) for way in ways)
        points.append((sum(alone.values()), sum(many.values())))
        print(f"| {number} | {_words(alone)} | {_words(many)} |", flush=True)
    (first, first_many), (last, last_many) = points[0], points[-1]
    share = (last_many - first_many) / (last - first)
    print(f"overhead per package {share - 1:+.1%}, fixed start {first_many - share * first:.1f} s")


def _builds(folder: Path, named: list[str], way: tuple[str, ...], repeat: int) -> Iterator[dict[str, float]]:
    """Yield the processor seconds of cold builds by role."""
    for _ in range(repeat):
        yield _measured("build", *named, "--store", str(folder / "store"), *way).seconds
        shutil.rmtree(folder / "store")
        shutil.rmtree(folder / "artifacts", ignore_errors=True)


def _memory(folder: Path, checkouts: list[Path], copies: list[int]) -> None:
    print("| repositories | code | peak of a reader / of another process of the cluster / of the merge | disk |")
    print("|---|---|---|---|")
    for number in copies:
        named = _repositories(folder / "src", checkouts, number)
        store, artifacts = folder / f"store{number}", folder / f"artifacts{number}"
        use = _measured("build", *named, "--store", str(store), "--cluster", "local:2", "--artifacts", str(artifacts))
        code = sum(path.stat().st_size for one in named for path in Path(one).rglob("*") if path.suffix in _CODE)
        peaks = " / ".join(f"{use.peaks.get(role, 0):.0f} MB" for role in ("reader", "other", "build"))
        print(
            f"| {number} | {code / 1e6:.1f} MB | {peaks} | {_size(store):.0f} + {_size(artifacts):.0f} MB |", flush=True
        )
        shutil.rmtree(store)
        shutil.rmtree(artifacts)


def _writer(folder: Path, checkouts: list[Path], copies: list[int]) -> None:
    print("| repositories | peak of the process that writes, anonymous / all | processor seconds |\n|---|---|---|")
    for number in copies:
        named = _repositories(folder / "src", checkouts, number)
        store = folder / f"store{number}"
        command = ("build", *named, "--store", str(store))
        _measured(*command)
        for name in ("store", "changes"):
            shutil.rmtree(store / name)
        (store / "current").unlink()
        use = _measured(*command)
        print(
            f"| {number} | {use.own['build']:.0f} / {use.peaks['build']:.0f} MB | {use.seconds['build']:.1f} |",
            flush=True,
        )
        shutil.rmtree(store)


_CODE: Final = frozenset({".cpp", ".cc", ".hpp", ".h", ".py"})


def _size(folder: Path) -> float:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 1e6


def _descendants(process: int) -> list[int]:
    """Return the processes that a process started, and those that these did."""
    parents: dict[int, list[int]] = {}
    for path in Path("/proc").iterdir():
        if path.name.isdigit() and (fields := _fields(int(path.name))):
            parents.setdefault(int(fields[1]), []).append(int(path.name))
    found = list(parents.get(process, ()))
    for one in found:
        found += parents.get(one, ())
    return found


def _is_worker(process: int) -> bool:
    """Tell whether a process is a worker of the cluster, or reads packages for one."""
    command = _file(process, "cmdline")
    return _READER in command or b"spawn_main" in command


def _fields(process: int) -> list[bytes]:
    """Return the fields of /proc/PID/stat after the name: the state, the parent, and so on."""
    return _file(process, "stat").rpartition(b")")[2].split()


def _processor_seconds(process: int) -> float:
    fields = _fields(process)
    return (int(fields[11]) + int(fields[12])) / _TICKS if fields else 0.0


def _megabytes(process: int) -> tuple[float, float]:
    """Return the proportional size of a process, and the anonymous part of it."""
    sizes = {line.split()[0]: int(line.split()[1]) / 1e3 for line in _file(process, "smaps_rollup").splitlines()[1:]}
    return sizes.get(b"Pss:", 0.0), sizes.get(b"Pss_Anon:", 0.0)


def _file(process: int, name: str) -> bytes:
    try:
        return Path(f"/proc/{process}/{name}").read_bytes()
    except OSError:
        return b""


if __name__ == "__main__":
    main()
