"""A finding of a rule about a system, as read from the store."""

from __future__ import annotations

from dataclasses import dataclass, field
from hashlib import blake2b

from kg.codes import SEVERITIES


@dataclass(frozen=True, slots=True, order=True)
class Evidence:
    """A line that supports a finding: `path` is relative to the root of `repository`.

    `words` describe it (`publishes /scan_raw`), `chain` has the includes that lead to it.
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
    """A finding; the first of `subjects` is the name that it is about.

    `system` is the configuration in which it was found, `source` the source of its launch file. `also` are others with
    the same fault at the same line. `place` is the line to fix; None if the rule names none. `presumes_whole` marks a
    conclusion from something missing, which holds only if the configuration is started alone. `replacement` is the
    suggested name for the first subject. `iri` is that of the finding in the store.
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
    source: str = ""

    @property
    def path(self) -> str:
        """The file to fix, by default that of the launch file."""
        return self.place.path if self.place else self.system

    @property
    def line(self) -> int | None:
        """The line in that file."""
        return self.place.line if self.place else None

    @property
    def in_own_file(self) -> bool:
        """Whether its line is in the launch file that names the system."""
        _, source, path = self.system.rpartition(":")
        rest = path if source else path.partition("/")[2]
        return self.place is not None and bool(rest) and f"/{self.place.path}".endswith(f"/{rest}")

    @property
    def fingerprint(self) -> str:
        """A digest of code, rule, system and subjects, which does not change when lines move."""
        parts = (self.code, self.rule, self.system, *sorted(self.subjects))
        return blake2b("\0".join(parts).encode(errors="surrogatepass"), digest_size=10).hexdigest()

    @property
    def order(self) -> tuple[int, str, int, str, tuple[str, ...], str]:
        """The sort key: severity, file, line."""
        rank = SEVERITIES.index(self.severity) if self.severity in SEVERITIES else len(SEVERITIES)
        return rank, self.path, self.line or 0, self.code, self.subjects, self.system
