"""What robots are measured by: `python benchmarks/robot ros1`; README.md says what is measured."""

from __future__ import annotations

import sys

import ros1

if __name__ == "__main__":
    ros1.main(sys.argv[2:] if sys.argv[1:2] == ["ros1"] else sys.argv[1:])
