"""What equal terms cost: a chain of `owl:sameAs` under the family owl-rl, from file to file, in a store, on demand."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Final

import demanding
import generating
from pyoxigraph import NamedNode

from kg.resources import folder as shipped
from kg.rules.reading import discover
from kg.rules.recording import Names
from kg.rules.running import Runner, run_files
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["measure"]

_SAME: Final = "<http://www.w3.org/2002/07/owl#sameAs>"
_NAMES: Final = Names.of(generating.BASE, generating.RNKG)
_SOURCE: Final = NamedNode(f"{generating.BASE}graph/source/benchmark")


def measure(length: int, folder: Path) -> dict[str, Any]:
    """Measure a chain of so many pairs, print, and return the figures; times are seconds of the processor."""
    links = [_line(number) for number in range(length)]
    path = folder / f"chain{length}.nt"
    path.write_text("".join(links))
    rules = discover([shipped("rules")], families=["owl-rl"])
    begin = time.process_time()
    report = run_files([path], folder / "inferred.nt", rules)
    figures: dict[str, Any] = {"pairs": length, "inferred": report.inferred}
    figures["file to file"] = time.process_time() - begin
    store = EmbeddedStore.create(folder / f"equal{length}")
    runner = Runner(_NAMES, store.layout.cache)
    one = links[length // 2].encode()
    with store.write("benchmark") as transaction:
        transaction.patch_graph(_SOURCE, b"", "".join(links).encode())
    seconds, found = demanding.query(
        store, rules, f"<{generating.BASE}a{length // 2}> {_SAME} ?x", store.layout.cache / "on-demand"
    )
    if found != length + 1:
        raise SystemExit(f"{found} terms are equal to one of {length + 1:,}")
    figures["what one term equals, on demand"] = seconds
    for name, gone, come in (
        ("store, first run", b"", b""),
        ("store, a pair in the middle deleted", one, b""),
        ("store, the pair inserted", b"", one),
    ):
        with store.write("benchmark") as transaction:
            transaction.patch_graph(_SOURCE, gone, come)
        begin = time.process_time()
        runner.run(store, rules)
        figures[name] = time.process_time() - begin
    for name, value in figures.items():
        print(f"{name:36} {value:.3f}" if isinstance(value, float) else f"{name:36} {value:,}")
    return figures


def _line(number: int) -> str:
    return f"<{generating.BASE}a{number}> {_SAME} <{generating.BASE}a{number + 1}> .\n"
