"""Marks: what the readers of C++ and Python saw of frameworks, before it is known what the frameworks make of it.

A reader of code records that a node *uses* a framework; which topics, services and parameters that framework then
makes by itself is in `ontology/implicit.toml`, as data, and is added by `kg.extract.implicit`.

The keys (`namespace` and `detail` are empty where a line does not name them; names follow `kg.facts.Interface.name`):

* `ros1.node`, `ros2.node`: every node has this; `kg.extract.implicit` adds it by `NodeType.ros`, readers need not.
* `rcl.node`: a node of rcl or rclc in C, which has less than those of the client libraries.
* `rclc.parameter_server`: a parameter server of rclc.
* `ros2.lifecycle`: the node is a lifecycle node.
* `ros2.parameter_client`: a client of the parameters of another node; `detail` is the name of that node.
* `tf.listener`: `tf` or `tf2_ros` transform listener.
* `tf.broadcaster`, `tf.static_broadcaster`: transform broadcasters.
* `tf2.buffer_debug`: a ROS 1 `tf2_ros` buffer made with `debug` (the default of `rospy`'s).
* `diagnostics.updater`: `diagnostic_updater::Updater`.
* `diagnostics.self_test`: `self_test::TestRunner`.
* `bond`: a bond; `detail` is its topic.
* `dynamic_reconfigure.server`: `namespace` is the one of the handle it was made with (`~` when it was made without,
  `~/costmap`, ...), `detail` the configuration as `package/Name` (`amcl/AMCL`, without `Config`), or None.
* `dynamic_reconfigure.client`: `namespace` is the name of the node it configures.
* `image_transport.publisher`: `detail` is the base topic, with the namespace of its handle in front.
* `image_transport.subscriber`: `detail` is the base topic, with the namespace of its handle in front.
* `point_cloud_transport.publisher`: `detail` is the base topic, with the namespace of its handle in front.
* `cuda_blackboard.publisher`, `cuda_blackboard.subscriber`: `detail` is the topic of the messages for the CPU.
* `interactive_markers.server`: `detail` is its topic namespace.
* `smach.introspection`: an introspection server of `smach_ros`; `detail` is its name.
* `jsk_topic_tools.transport`: a class derived from `jsk_topic_tools.ConnectionBasedTransport` that is not in the build.

The base interface itself (`image` and `camera_info` of a camera publisher, the action of an action server) is an
ordinary interface of the node and not the business of a mark.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kg.facts import Location, NodeType


@dataclass(frozen=True, slots=True)
class Mark:
    """A use of a framework at a line of code; the module's docstring lists the keys."""

    key: str
    location: Location
    namespace: str = ""
    detail: str | None = None
    via: tuple[Location, ...] = field(default=(), compare=False)
    """The calls from there to the framework, as for `kg.facts.Interface`."""


@dataclass(frozen=True, slots=True)
class Extracted:
    """A node as a reader of code found it, with the frameworks that it uses."""

    node: NodeType
    marks: tuple[Mark, ...] = ()
