"""Parameters declared outside of code: `generate_parameter_library` (ROS 2) and dynamic_reconfigure (ROS 1)."""

from kg.extract.parameters.attaching import attach, read_generated
from kg.extract.parameters.listener import listener
from kg.extract.parameters.reconfigure import read_configuration

__all__ = ["attach", "listener", "read_configuration", "read_generated"]
