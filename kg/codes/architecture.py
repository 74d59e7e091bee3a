"""The codes of `kg lint`: KG401 to KG417 are findings of the rules in `rules/architecture/`, KG42x its own errors."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG401": CodeEntry(
        "topic almost published",
        "A node subscribes to a topic that nothing in the launch configuration publishes to. A topic with a similar "
        "name and the same type is published. Likely causes: a typo, a namespace too many or missing, a plural.",
        "Remap one of the two names to the other, or correct the remapping or parameter that makes it.",
    ),
    "KG402": CodeEntry(
        "topic almost subscribed",
        "A node publishes to a topic that nothing in the launch configuration subscribes to. A topic with a similar "
        "name and the same type has a subscriber.",
        "Remap one of the two names to the other. Leave it if the topic needs no subscriber.",
    ),
    "KG403": CodeEntry(
        "types of a topic clash",
        "Publisher and subscriber of a topic use different types. ROS does not connect the two.",
        "Remap one of the two to another name, or add a node that converts between the types.",
    ),
    "KG404": CodeEntry(
        "service or action without server",
        "A node calls a service or an action that has no server of this name in the launch configuration.",
        "Remap the client to the name of an existing server, or start the server's node.",
    ),
    "KG405": CodeEntry(
        "types of a service or action differ",
        "Client and server of a service or an action use different types. Calls fail.",
        "Remap the client to the intended service, or correct the type in the code.",
    ),
    "KG406": CodeEntry(
        "remapping without effect",
        "The left side of a remapping is not a name that the node uses. The remapping changes nothing.",
        "Write a name that the node uses, or remove the remapping.",
    ),
    "KG407": CodeEntry(
        "remapping to nothing",
        "A remapping leads a publisher or subscriber to a topic without a counterpart.",
        "Correct the right side, or remap the other end to the same name.",
    ),
    "KG408": CodeEntry(
        "parameter never read",
        "A parameter is set for a node, but the node never reads a parameter of this name.",
        "Write the name that the node reads, or remove the setting.",
    ),
    "KG409": CodeEntry(
        "parameter without valid topic",
        "A parameter supplies the name of a topic or service. It is empty, or set to a name that no other node uses.",
        "Set the parameter to the name that the other end uses.",
    ),
    "KG410": CodeEntry(
        "incompatible quality of service",
        "A subscriber requests more than the publisher offers, so the middleware of ROS 2 does not connect them. The "
        "settings compared are reliability, durability, deadline, liveliness and lease duration.",
        "Raise what the publisher offers, or lower what the subscriber requests.",
    ),
    "KG411": CodeEntry(
        "duplicate node name",
        "A launch configuration starts two nodes under one absolute name. In ROS 1, the second one shuts the first "
        "one down.",
        "Give one of them another name or namespace.",
    ),
    "KG412": CodeEntry(
        "included file missing",
        "A launch file includes or loads a file that is missing from its package.",
        "Correct the path, or add the file.",
    ),
    "KG413": CodeEntry(
        "argument not declared or not given",
        "A launch file passes or reads an argument that nothing declares, or an include omits a required argument.",
        "Declare the argument, correct its name, pass it, or give it a default.",
    ),
    "KG414": CodeEntry(
        "node not found",
        "A launch file starts a program, or loads a class, that is missing from its package.",
        "Correct the name of the program or of the package.",
    ),
    "KG415": CodeEntry(
        "launch file cannot be read",
        "A launch file, or a parameter file that it loads, is not valid XML, YAML or Python. Or it contains something "
        "that launch refuses, such as a missing attribute or an invalid condition. The rest of the file was skipped.",
        "Correct the line. XML errors are often reported at the end of the element that contains them.",
    ),
    "KG416": CodeEntry(
        "parameter of another type",
        "A parameter is set to a value of another type than the node reads. In ROS 2, the node exits when it declares "
        "the parameter. In ROS 1, the node uses its default or exits.",
        "Write a value of the type that the code declares. In ROS 2, write a double with a decimal point (`1.0`).",
    ),
    "KG417": CodeEntry(
        "launch files of ROS 1 in a package of ROS 2",
        "A package of ROS 2 has launch files with elements, attributes or substitutions that only ROS 1 supports. "
        "`ros2 launch` refuses them, and kg does not evaluate them.",
        "Port the files, or remove them.",
    ),
    "KG420": CodeEntry(
        "unusable baseline",
        "The baseline file is missing, unreadable, or not in the format of `kg lint --write-baseline`.",
        "Write it again with `kg lint --write-baseline FILE`, and review the changes.",
    ),
    "KG421": CodeEntry(
        "unusable allowance",
        "An entry of the allow-list in kg.toml has no reason, an unknown code or an unknown key.",
        "Give the entry a code of a finding (`kg explain KG401`) and the reason for accepting it.",
    ),
    "KG422": CodeEntry(
        "unknown launch file",
        "The name matches no launch file of the build, or several.",
        "Give the path of the file, or its package and the path in it. Packages are read by `kg build`.",
    ),
}
