from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Final

from patience import patient

CASE: Final = Path(__file__).parent / "rules_case"


def test_watching_ends_quietly(tmp_path: Path) -> None:
    """`kg rules watch` checks the rules at once, and exits with 0 on Ctrl-C."""
    shutil.copytree(CASE, tmp_path, dirs_exist_ok=True)
    surroundings = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
    with subprocess.Popen(
        [sys.executable, "-m", "kg", "rules", "watch", "wiring"],
        cwd=tmp_path,
        env=surroundings,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        shown = ""
        while "watching" not in shown:
            line = process.stderr.readline()
            assert line, shown
            shown += line
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=patient(60))
    assert process.returncode == 0
    assert err.endswith("stopped\n")
    assert "ok    wiring/talks-to  2 examples" in out
    assert "\x1b" not in out
