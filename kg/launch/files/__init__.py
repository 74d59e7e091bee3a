"""Launch files are evaluated without running anything: ROS 1 XML, and ROS 2 XML, YAML and Python."""

from __future__ import annotations

from kg.launch.files.reading import read_configuration, read_launches

__all__ = ["read_configuration", "read_launches"]
