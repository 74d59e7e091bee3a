"""What rules found wrong in a system, as it is read from the store."""

from __future__ import annotations

from dataclasses import dataclass, field
from hashlib import blake2b

from kg.codes import SEVERITIES


@dataclass(frozen=True, slots=True, order=True)
class Evidence:
    """A line that has to do with a finding: `path` is relative to the root of `repository`.

    `words` say what happens there (`publishes /scan_raw`), `chain` through which includes it came.
    """

    path: str
    line: int | None
    repository: str
    words: str = ""
    chain: str = ""

    def __str__(self) -> str:
        return self.path if self.line is None else f"{self.path}:{self.line}"


@dataclass(frozen=True, slots=True)
class Finding:
    """One finding: `subjects` begins with the name that it is about before all others.

    `system` is the name of the configuration that it was found in, `also` are those with the same fault at the same
    line. `place` is the line where it is to be mended; None when the rule names none. `presumes_whole` tells that it is
    concluded from something missing, so that it holds only where the configuration is started alone. `replacement` is
    the name that probably should stand in place of the first subject. `iri` is that of the finding in the store.
    """

    code: str
    rule: str
    severity: str
    system: str
    message: str
    subjects: tuple[str, ...] = ()
    place: Evidence | None = None
    evidence: tuple[Evidence, ...] = ()
    presumes_whole: bool = False
    hint: str | None = None
    replacement: str | None = None
    also: tuple[str, ...] = field(default=())
    iri: str = field(default="", compare=False)

    @property
    def path(self) -> str:
        """The file where it is to be mended, the launch file's name where none is known."""
        return self.place.path if self.place else self.system

    @property
    def line(self) -> int | None:
        """The line in that file."""
        return self.place.line if self.place else None

    @property
    def in_own_file(self) -> bool:
        """Whether its line stands in the launch file that the system is named by."""
        _, source, path = self.system.rpartition(":")
        rest = path if source else path.partition("/")[2]
        return self.place is not None and bool(rest) and f"/{self.place.path}".endswith(f"/{rest}")

    @property
    def fingerprint(self) -> str:
        """What stays the same when lines move: a digest of code, rule, system and subjects."""
        parts = (self.code, self.rule, self.system, *sorted(self.subjects))
        return blake2b("\0".join(parts).encode(errors="surrogatepass"), digest_size=10).hexdigest()

    @property
    def order(self) -> tuple[int, str, int, str, tuple[str, ...], str]:
        """What findings are sorted by: severity, file, line."""
        rank = SEVERITIES.index(self.severity) if self.severity in SEVERITIES else len(SEVERITIES)
        return rank, self.path, self.line or 0, self.code, self.subjects, self.system
