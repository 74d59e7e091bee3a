"""Tokenizer for texts about robots, which preserves identifiers.

spaCy's rules for English split `sensor_msgs/LaserScan` and `AT91SAM7-EK/2` like `and/or`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from spacy.tokenizer import Tokenizer  # type: ignore[import-not-found]  # has no stub
from spacy.util import compile_infix_regex, compile_prefix_regex, compile_suffix_regex, registry

if TYPE_CHECKING:
    from collections.abc import Callable

    from spacy.language import Language

_IDENTIFIER: Final = re.compile(
    r"""
      [~/]?[a-z]\w*(?:/\w+)*/[A-Z]\w*             # sensor_msgs/LaserScan
    | [~/][A-Za-z]\w*(?:/\w+)*                    # /camera/image_raw, ~frame_id, /dev/ttyUSB0
    | \w+(?:::~?\w+)+                             # std::vector
    | (?=[\w/]*_)[A-Za-z]\w*(?:/\w+)*             # base_link, robot_1/cmd_vel
    | \w+\.(?:launch|yaml|yml|xml|py|cpp|hpp|h|cc|urdf|xacro|bag|txt|cfg|msg|srv|action|so|rviz|world|sdf|pgm|md)
      (?:\.(?:py|xml|yaml))?                      # demo.launch.py
    | (?:rad|deg|k?m|[cm]m)/(?:s|h)(?:\^?2)?        # rad/s, m/s^2
    | [A-Z]{1,8}\d*[A-Za-z]?-\d+\w*(?:-\w+)*      # UTM-30LX, VLP-16, LMS-151
    """,
    re.VERBOSE,
)
"""Single words that contain signs."""

_RUNS: Final = (r"[!?]{2,}", r"[-=_~*]{2,}", r"\${2,}", r"<{2,}", r">{2,}", r"\+{2,}")
"""Repeated signs that are one word, as in the treebank: rows of dashes, `!!`."""
_JOINED: Final = ("and/or",)  # words that spaCy preserves and the treebank splits


def make_tokenizer() -> Callable[[Language], Tokenizer]:
    """Return a function that creates the tokenizer of a pipeline: spaCy's English rules, and those of this module."""
    return _make


def _make(nlp: Language) -> Tokenizer:
    # In one call: setting a property of a tokenizer later parses the special cases again.
    defaults = nlp.Defaults
    return Tokenizer(
        nlp.vocab,
        rules={text: rule for text, rule in (defaults.tokenizer_exceptions or {}).items() if text not in _JOINED},
        prefix_search=compile_prefix_regex([*_RUNS, "-", *(defaults.prefixes or ())]).search,
        suffix_search=compile_suffix_regex([*_RUNS, r"(?<=\w\w)\.", *(defaults.suffixes or ())]).search,
        infix_finditer=compile_infix_regex([*_RUNS, *(defaults.infixes or ())]).finditer,
        token_match=_IDENTIFIER.fullmatch,
        url_match=defaults.url_match,
    )


registry.tokenizers.register("kg.Tokenizer.v1", func=make_tokenizer)
