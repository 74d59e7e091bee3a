"""Programs as behaviour trees of BehaviorTree.CPP, version 4: XML that other tools and robots run, and back.

Each statement becomes a few standard nodes. Capabilities become actions, described in the `TreeNodesModel`: one that
does something has an input port for each parameter, one that senses has output ports. The attributes `_kg` and
`_description`, which BehaviorTree.CPP ignores, keep the statement as written and its comment.
"""

from __future__ import annotations

from kg.robot.programs.trees.exporting import behavior_tree
from kg.robot.programs.trees.importing import program_of

__all__ = ["behavior_tree", "program_of"]
