"""The front end for C++: the nodes of a package and what they declare, for ROS 1 and ROS 2.

`syntax` parses; `expressions`, `statements` and `units` lower one file to the form of `kg.symbolic`. `project` reads
the files of a package and its includes, and `linking` resolves names across them. `language` gives the interpreter the
meaning of C++, with `kinds` (types), `calls`, `construction`, `callbacks` and `library` (standard library and Boost).
`nodes` interprets the entries of a package, and `kg.extract.declared` converts what they declare.
"""

from __future__ import annotations

from kg.extract.cpp.nodes import read_nodes

__all__ = ["read_nodes"]
