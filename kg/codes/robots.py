"""The codes of robots: KG801 to KG852."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG801": CodeEntry(
        "invalid robot address",
        "The format of the robot's address is unknown, or its middleware is not installed.",
        "Write ros1://HOST:PORT, dds://DOMAIN, rclpy://DOMAIN, zenoh://HOST:PORT, ws://HOST:PORT or bag://FILE. "
        "Install the package that the message names.",
    ),
    "KG802": CodeEntry(
        "robot does not answer",
        "Nothing answers at the address of the robot, or the answer is not from a ROS master or peer.",
        "Check whether the robot is running and the address is right. To try one, run `kg robot simulate office`.",
    ),
    "KG803": CodeEntry(
        "connection lost",
        "The connection to the robot or to one of its nodes ended, or timed out. The robot might still be moving.",
        "Check whether the robot is moving. Then restart the node and try again.",
    ),
    "KG804": CodeEntry(
        "unknown message type",
        "kg does not include this message type, and no peer sent its definition.",
        "Build the package that defines it with `kg build`, or start the node that publishes it.",
    ),
    "KG805": CodeEntry(
        "value does not fit",
        "A value does not fit its field of the message.",
        "Give a value of the type that the message names.",
    ),
    "KG806": CodeEntry(
        "types differ",
        "A peer uses another definition (MD5 sum, hash or type) of the interface.",
        "Build both sides from the same version of the interface package.",
    ),
    "KG807": CodeEntry(
        "no server",
        "The service or action has no server.",
        "Start the node that serves it. `kg robot capabilities --live` lists the available ones.",
    ),
    "KG808": CodeEntry(
        "service failed",
        "The server of the service reported a failure.",
        "Read the message from that node.",
    ),
    "KG809": CodeEntry(
        "goal not reached",
        "The action server rejected, aborted or cancelled the goal.",
        "Check the status, and try a goal that the robot can reach.",
    ),
    "KG810": CodeEntry(
        "peer breaks the protocol",
        "A peer violated its protocol, for example by an endless header, an oversized message or broken XML.",
        "The peer is ignored. Check the node that the message names.",
    ),
    "KG818": CodeEntry(
        "capability not found",
        "No node of the system or package has a capability of this name.",
        "List all of them, including general ones, with `kg robot capabilities --all`.",
    ),
    "KG819": CodeEntry(
        "node not active",
        "The robot has the capability, but the nodes that provide it are managed (ROS 2 life cycle) and in another "
        "state than `active`. They do no work in that state.",
        "Activate the node that the message names: `ros2 lifecycle set NODE activate`, or start its lifecycle manager. "
        "`kg robot nodes` shows the states.",
    ),
    "KG843": CodeEntry(
        "parameter not set",
        "The node has no parameter of this name, it is read-only, the value has another type or is outside the limits "
        "that the node describes, or the node refused the value.",
        "Give a value as the message describes. `kg robot params NODE NAME` shows type, limits and meaning.",
    ),
    "KG845": CodeEntry(
        "server without a robot",
        "This server was started without the address of a robot.",
        "Start it with `kg serve --robot ros1://HOST:PORT`. To try a robot, run `kg robot simulate office`.",
    ),
    "KG846": CodeEntry(
        "robot not connected",
        "The server has the address of a robot, but is currently not connected to it.",
        "Check whether the robot is running. The server retries, and the page reports the connection.",
    ),
    "KG847": CodeEntry(
        "robot is busy",
        "A program or manual control already moves the robot, or too many pages are connected.",
        "Stop the program or movement, or wait until it ends.",
    ),
    "KG848": CodeEntry(
        "invalid duration of a manual movement",
        "The duration of a manual movement is zero or exceeds the limit for supervised movements.",
        "Choose a duration within the limit, or write a program.",
    ),
    "KG849": CodeEntry(
        "page not connected",
        "Manual control and live updates need an open page, and this page is not connected any more.",
        "Reload the page.",
    ),
    "KG850": CodeEntry(
        "unreadable recording",
        "The file is missing, broken, unfinished, or not a recording (.bag, .mcap, .db3 or the folder of a bag).",
        "Check the path. `rosbag reindex` or `ros2 bag reindex` repairs recordings that were not finished.",
    ),
    "KG851": CodeEntry(
        "recording cannot be commanded",
        "A recording contains what a robot published. It has no topics, services or actions to send commands to.",
        "Use `kg robot read`, or name a running robot with --robot.",
    ),
    "KG852": CodeEntry(
        "not possible over a bridge",
        "A bridge to WebSockets carries topics and services, some only from the robot. kg gives no goals over it and "
        "serves nothing.",
        "Connect by ros1://, dds:// or zenoh://, or use a topic or service (`--way`).",
    ),
    "KG811": CodeEntry(
        "dead node",
        "The ROS 1 master still lists a node that does not answer. The node crashed or hangs.",
        "Start the node again, or remove it from the master with `rosnode cleanup`.",
    ),
    "KG812": CodeEntry(
        "invalid ROS name",
        "A node uses a name, type or address that violates the rules of ROS 1.",
        "Correct the name. Until then, its entry is missing from the computation graph.",
    ),
    "KG813": CodeEntry(
        "peer refused a call",
        "The ROS 1 master or a node answered a call with an error.",
        "Read the message from the peer.",
    ),
    "KG814": CodeEntry(
        "own node unreachable",
        "$ROS_HOSTNAME or $ROS_IP names an address of another machine, so peers cannot connect.",
        "Set ROS_IP to this machine's address on the robot's network, or unset both.",
    ),
    "KG815": CodeEntry(
        "incompatible quality of service",
        "Two ends of a ROS 2 topic are not connected, because one requests more than the other offers.",
        "Give both ends the same reliability, durability, deadline and liveliness.",
    ),
    "KG816": CodeEntry(
        "invalid data from a ROS 2 peer",
        "A peer sent an invalid name, a broken discovery message, or a message that cannot be decoded.",
        "It is ignored. Check the node that the message names, and the version of its interface package.",
    ),
    "KG817": CodeEntry(
        "cannot join a ROS 2 system",
        "The middleware cannot open the domain or the session, for example without a network.",
        "Check the network, and $CYCLONEDDS_URI or the router that the address names.",
    ),
    "KG820": CodeEntry(
        "robot did not move",
        "A robot received a velocity, but measured no motion. A landed drone ignores velocities. So does a base that "
        "is blocked, has its motors off, or is in emergency stop.",
        "Start a drone first (`kg robot do takingOff`). Switch the motors on, and check the robot.",
    ),
    "KG821": CodeEntry(
        "unknown capability",
        "No capability of the robot has this name, label or alternative label.",
        "List the capabilities with `kg robot capabilities --live`.",
    ),
    "KG822": CodeEntry(
        "capability not available",
        "The robot does not offer the capability, or not in the named way. Or the capability can only be read.",
        "List the topics, services and actions of each capability with `kg robot capabilities --live`.",
    ),
    "KG823": CodeEntry(
        "invalid argument",
        "A parameter of a capability is unknown, has no value, or has one of the wrong kind or unit. Or the value is "
        "outside its limits or choices.",
        "Give a value as the message describes. kg does not clamp values to the limits.",
    ),
    "KG824": CodeEntry(
        "no subscriber",
        "A command's topic has no subscriber, or lost its subscriber.",
        "Start the node that subscribes to it. Any movement in progress was stopped.",
    ),
    "KG825": CodeEntry(
        "timeout",
        "No message arrived in time, or the goal was not reached in time. The goal was cancelled.",
        "Check whether the node works, or increase the time.",
    ),
    "KG826": CodeEntry(
        "invalid field path",
        "The path from a parameter to a message field is malformed, or does not fit the message.",
        "Correct `rnkg:field` in the ontology as the message describes.",
    ),
    "KG827": CodeEntry(
        "part already in use",
        "Another topic or action already moves this part of the robot. Two commands would conflict.",
        "Stop the other movement, or wait until it ends. The ontology lists the parts that each capability moves.",
    ),
    "KG828": CodeEntry(
        "controller stalled",
        "The process that drives the robot was suspended, blocked or killed, or lost the connection while the robot "
        "moved. Its watchdog stopped the robot: it sent zero velocity to every moving topic and cancelled every goal. "
        "After a loss, it tries to do so for a minute.",
        "Give the command again, because nothing resumes by itself. On a busy machine, increase the timeout: "
        "`KG_WATCHDOG=2`.",
    ),
    "KG829": CodeEntry(
        "another controller",
        "Another node publishes velocities to the same topic: a second `kg`, a joystick, navigation. A base follows "
        "both by turns.",
        "Stop the other node. With `--exclusive`, kg refuses to drive in this case.",
    ),
    "KG830": CodeEntry(
        "program does not parse",
        "The text of a program violates the grammar of the language.",
        "Correct the program at the place given. docs/programs.md describes the language.",
    ),
    "KG831": CodeEntry(
        "invalid program tree",
        "The JSON of a program violates its schema.",
        "Compare it with docs/program.schema.json at the path that the message names.",
    ),
    "KG832": CodeEntry(
        "program exceeds the robot's capabilities",
        "A program names a capability, parameter or value that the robot lacks.",
        "List capabilities and parameters with `kg robot capabilities`.",
    ),
    "KG833": CodeEntry(
        "kinds or units do not match",
        "A program mixes incompatible values: metres with seconds, a text where a number is needed.",
        "Give a value of the kind and unit that the message names.",
    ),
    "KG834": CodeEntry(
        "read and write confused",
        "A program executes a read-only capability, or reads one that can only be executed.",
        "Write `nearest of laserScanning` to read a capability. Write a separate statement to execute one.",
    ),
    "KG835": CodeEntry(
        "value out of bounds",
        "A value in a program is outside the limits or choices of its parameter.",
        "Give a value within the limits or choices.",
    ),
    "KG836": CodeEntry(
        "inconsistent program",
        "A variable has no value yet, `break` is outside a loop, a loop never waits, or parts collide.",
        "Correct the block that the message names.",
    ),
    "KG837": CodeEntry(
        "program took too long",
        "A program, or a wait in it, exceeded its time, or ran too many steps without waiting.",
        "Give it more time (`within`), or add a wait to its loops.",
    ),
    "KG838": CodeEntry(
        "program failed",
        "A statement failed with its current values. The robot was stopped.",
        "Check the block that the message names.",
    ),
    "KG839": CodeEntry(
        "program cannot be converted",
        "The capability has no topic, service or action to generate code for.",
        "Convert the program for a robot (`--robot`, `--launch`) that has the capability.",
    ),
    "KG840": CodeEntry(
        "simulation not installed",
        "Simulated worlds need pybullet and OpenCV, which are an optional part of `kg`.",
        "Install them with `pip install 'kg-ros[simulate]'`.",
    ),
    "KG841": CodeEntry(
        "no behaviour tree for a program",
        "BehaviorTree.CPP has no standard nodes for a statement or a calculation of the program.",
        "Change the statement that the message names. docs/programs.md lists what has a behaviour tree.",
    ),
    "KG842": CodeEntry(
        "no program for a behaviour tree",
        "The file is not a behaviour tree of BehaviorTree.CPP 4, or has a node without a matching statement.",
        "Change the node at the line given. docs/programs.md lists the nodes that become statements.",
    ),
}
