"""Rules of the internal form as text: in each notation, and as the form itself for people.

Each function takes all rules of a file and returns the text of one. A rule that a notation cannot express raises
RuleError KG209 with the part.
"""

from __future__ import annotations

from kg.rules.printing.form import to_form
from kg.rules.printing.rq import of_data, to_rq
from kg.rules.printing.srl import to_srl
from kg.rules.printing.turtle import to_turtle

__all__ = ["of_data", "to_form", "to_rq", "to_srl", "to_turtle"]
