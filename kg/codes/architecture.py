"""The codes of findings in the wiring of systems, which the rules of `rules/architecture/` make: KG401 to KG417."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG401": CodeEntry(
        "topic almost published",
        "A node subscribes a topic that nothing in the launch configuration publishes, while a topic of a like name "
        "and the same type is published: a slip of spelling, a namespace too many or missing, a plural.",
        "Remap one of the two names to the other, or correct the remapping or parameter that makes it.",
    ),
    "KG402": CodeEntry(
        "topic almost subscribed",
        "A node publishes a topic that nothing in the launch configuration subscribes, while a topic of a like name "
        "and the same type is subscribed.",
        "Remap one of the two names to the other, or leave it where nobody has to hear.",
    ),
    "KG403": CodeEntry(
        "types of a topic clash",
        "A topic is subscribed with another type than it is published with: ROS does not connect the two.",
        "Remap one of the two to another name, or convert between the types by a node of its own.",
    ),
    "KG404": CodeEntry(
        "service or action not offered",
        "A node calls a service or an action that nothing in the launch configuration offers under this name.",
        "Remap the client to the name that is offered, or start the node that offers it.",
    ),
    "KG405": CodeEntry(
        "types of a service or action differ",
        "A service or an action is called with another type than it is offered with: calls fail.",
        "Remap the client to the service it means, or correct the type in the code.",
    ),
    "KG406": CodeEntry(
        "remapping of nothing",
        "The left side of a remapping is no name that the node has, so that it changes nothing.",
        "Write the name that the node has, or remove the remapping.",
    ),
    "KG407": CodeEntry(
        "remapping to nothing",
        "A remapping leads an end of a topic to a name at which nobody is.",
        "Correct the right side, or remap the other end to the same name.",
    ),
    "KG408": CodeEntry(
        "parameter never read",
        "A parameter is set for a node that never reads one of that name.",
        "Write the name that the node reads, or remove the setting.",
    ),
    "KG409": CodeEntry(
        "parameter names no topic",
        "The name of a topic or service is read from a parameter that is empty, or that is set to a name nobody has.",
        "Set the parameter to the name that the other end has.",
    ),
    "KG410": CodeEntry(
        "qualities of service do not fit",
        "A subscriber asks for more than the publisher offers, in reliability, durability, deadline, liveliness or the "
        "lease of liveliness: the middleware of ROS 2 does not connect the two.",
        "Let the publisher offer what is asked for, or the subscriber ask for less.",
    ),
    "KG411": CodeEntry(
        "two nodes of one name",
        "A launch configuration starts two nodes under one absolute name: in ROS 1 the second ends the first.",
        "Give one of them another name or namespace.",
    ),
    "KG412": CodeEntry(
        "included file missing",
        "A launch file includes or loads a file that its package does not have.",
        "Correct the path, or add the file.",
    ),
    "KG413": CodeEntry(
        "argument not declared or not given",
        "An argument is passed to a launch file that does not declare it, is read where nothing declares it, or has no "
        "default and is not given by an include.",
        "Declare the argument, correct its name, pass it, or give it a default.",
    ),
    "KG414": CodeEntry(
        "no such node",
        "A launch file starts a program, or loads a class, that its package does not have.",
        "Correct the name of the program or of the package.",
    ),
    "KG415": CodeEntry(
        "launch file cannot be read",
        "A launch file, or a file of parameters that it loads, is no XML, YAML or Python, or has what launch refuses: "
        "an element without a required attribute, a condition that is neither true nor false. What stands behind the "
        "line is not known.",
        "Correct the line. An error of XML is often found at the end of the element that it began in.",
    ),
    "KG416": CodeEntry(
        "parameter of another type",
        "A parameter is set to a value of another type than the node reads it with. A node of ROS 2 ends when it "
        "declares the parameter; one of ROS 1 goes on with its default, or ends.",
        "Write a value of the type that the code declares; in ROS 2 a whole number for a double has a point (`1.0`).",
    ),
    "KG417": CodeEntry(
        "launch files of ROS 1 in a package of ROS 2",
        "A package of ROS 2 has launch files with elements, attributes or substitutions that only ROS 1 reads. "
        "`ros2 launch` refuses them; they are not evaluated.",
        "Port the files, or remove them.",
    ),
}
