from __future__ import annotations

import shutil
import subprocess
import sys

import pytest
from repository import ROOT

sys.path.append(str(ROOT / "docs"))
from command_pages import roff


def test_the_manual_page_is_current() -> None:
    """docs/kg.1 matches the commands; `python docs/generate.py` updates it."""
    page = ROOT / "docs" / "kg.1"
    assert page.read_text(encoding="utf-8") == roff()


@pytest.mark.skipif(shutil.which("groff") is None, reason="groff is not installed")
def test_roff_takes_the_page_without_a_warning() -> None:
    """Groff formats the page, with every command, without warnings."""
    command = ["groff", "-man", "-Tascii", "-ww", "-rLL=100n"]
    ran = subprocess.run(command, input=roff(), capture_output=True, text=True, check=True)
    assert ran.stderr == ""
    assert "kg completions" in ran.stdout


def test_no_line_of_text_is_a_request() -> None:
    """Text that begins with a dot or a quote is escaped; the only requests are those used by the page."""
    requests = {line.split()[0] for line in roff().splitlines() if line.startswith((".", "'"))}
    assert requests <= {".TH", ".SH", ".SS", ".B", ".PP", ".TP", ".nf", ".fi"}
