"""Where words begin and end in texts about robots: identifiers stay whole.

spaCy's rules for English split `sensor_msgs/LaserScan` and `AT91SAM7-EK/2` as they split `and/or`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

from spacy.util import compile_infix_regex, compile_prefix_regex, compile_suffix_regex

if TYPE_CHECKING:
    from spacy.language import Language

__all__ = ["IDENTIFIER", "extend"]

IDENTIFIER: Final = re.compile(
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
"""What is one word though it has signs in it."""

_RUNS: Final = (r"[!?]{2,}", r"[-=_~*]{2,}", r"\${2,}", r"<{2,}", r">{2,}", r"\+{2,}")
"""Signs that are one word when they are repeated, as in the treebank: rows of dashes, `!!`."""
_JOINED: Final = ("and/or",)
"""What spaCy keeps whole and the treebank splits."""


def extend(nlp: Language) -> None:
    """Add the rules of this module to the tokenizer of `nlp`, which has those of spaCy for English."""
    defaults = nlp.Defaults
    prefixes = [*_RUNS, "-", *(defaults.prefixes or ())]
    suffixes = [*_RUNS, r"(?<=\w\w)\.", *(defaults.suffixes or ())]
    infixes = [*_RUNS, *(defaults.infixes or ())]
    tokenizer: Any = nlp.tokenizer
    tokenizer.prefix_search = compile_prefix_regex(prefixes).search
    tokenizer.suffix_search = compile_suffix_regex(suffixes).search
    tokenizer.infix_finditer = compile_infix_regex(infixes).finditer
    tokenizer.token_match = IDENTIFIER.fullmatch
    tokenizer.rules = {text: rule for text, rule in (tokenizer.rules or {}).items() if text not in _JOINED}
