"""Programs as behaviour trees of BehaviorTree.CPP 4: XML that other tools and robots run, and the reverse.

Each statement becomes a few standard nodes. Capabilities become actions, described in the `TreeNodesModel`: an
executable one has an input port for each parameter, a readable one has output ports. The attributes `_kg` and
`_description`, which BehaviorTree.CPP ignores, keep the statement's text and its comment.
"""

from __future__ import annotations

from kg.robot.programs.trees.exporting import behavior_tree
from kg.robot.programs.trees.importing import program_of

__all__ = ["behavior_tree", "program_of"]
