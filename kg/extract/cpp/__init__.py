"""The reader of C++: which nodes a package makes and what they declare, for ROS 1 and ROS 2.

`syntax` and `unit` know one file, `project` the files of a package and its includes, `program` what code of
them can run in one node. `evaluate` finds out what expressions are, backwards from where they stand, with
`flow`, `constants`, `variables`, `sites`, `types`, `library` and `callbacks`. `ros1` and `ros2` are tables of calls;
`calls` is the engine that finds and reads their uses; `nodes` puts it together.
"""

from __future__ import annotations

from kg.extract.cpp.nodes import read_nodes

__all__ = ["read_nodes"]
