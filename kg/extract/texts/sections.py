"""What the heading of a section tells of the paragraphs below it."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final

__all__ = ["is_about", "is_interface", "is_never", "is_telling"]

_REMEMBERED: Final = 2048
"""Headings whose meaning is kept, for many pages have the same."""

_NEVER: Final = (
    "install|licen[sc]e|citation|citing|cite|bibtex|contribut|changelog|change log|release|credit|acknowledg|author",
    "maintainer|to-?do|roadmap|prerequisite|requirement|dependenc|docker|publication|copyright|table of contents",
    "troubleshoot|known issue|build|compil|download|ci$|continuous integration|status|testing|tests?$|migrat|upgrad",
    "node_name|code api|contact|faq|supported (?:devices|hardware|platform)",
)
_INTERFACE: Final = (
    "parameter|argument|param|subscri|publish|topic|service|action|input|output|config|usage|launch|run(?:ning)?$",
    "run(?:ning)? |ros(?:run|launch)|ros2 |~|example|api$|tf$|transform|command line|option",
    "messages|how to|tutorial|quick|demo|sample",
)
_OTHER: Final = (
    "reference|support|bug|getting|set-?up|paper|develop|disclaimer|links|related|video|note|coding|debug|news|update",
    "history|issues|help|simulat|calibrat|performance|benchmark|evaluation|result|todo|workspace|file|folder|plugin$",
)
_ABOUT: Final = (
    "overview|description|introduc|about|feature|summary|what|purpose|synopsis|abstract|concept|functional",
)


def _any(words: tuple[str, ...]) -> re.Pattern[str]:
    return re.compile(rf"(?:\b|^)(?:{'|'.join(words)})", re.IGNORECASE)


_NEVER_PATTERN: Final = _any(_NEVER)
_INTERFACE_PATTERN: Final = _any(_INTERFACE)
_OTHER_PATTERN: Final = _any(_OTHER)
_ABOUT_PATTERN: Final = _any(_ABOUT)


@lru_cache(_REMEMBERED)
def is_never(heading: str) -> bool:
    """Tell whether nothing below a heading is a description, whatever it names."""
    return _NEVER_PATTERN.search(heading) is not None and not is_about(heading)


@lru_cache(_REMEMBERED)
def is_interface(heading: str) -> bool:
    """Tell whether a section lists topics, parameters or ways to start something."""
    return _INTERFACE_PATTERN.search(heading) is not None


@lru_cache(_REMEMBERED)
def is_about(heading: str) -> bool:
    """Tell whether a section says what the thing is that the section around it is about."""
    return _ABOUT_PATTERN.search(heading) is not None


@lru_cache(_REMEMBERED)
def is_telling(heading: str) -> bool:
    """Tell whether the section below the title of a README describes the package."""
    return not (is_never(heading) or is_interface(heading) or _OTHER_PATTERN.search(heading))
