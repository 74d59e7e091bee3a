"""What robots are measured by: `python benchmarks/robot ros1`; README.md says what is measured."""

from __future__ import annotations

import argparse
import asyncio
import sys

import ros1

if __name__ == "__main__":
    if sys.argv[1:2] == ["master"]:
        asyncio.run(ros1.serve_master(int(sys.argv[2])))
    else:
        parser = argparse.ArgumentParser(prog="robot", description=ros1.main.__doc__)
        parser.add_argument("system", nargs="?", choices=["ros1"], default="ros1", help="what to measure")
        parser.parse_args()
        ros1.main()
