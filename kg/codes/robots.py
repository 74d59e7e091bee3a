"""The codes of robots: KG801 to KG849."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG801": CodeEntry(
        "address of a robot",
        "The address of the robot is of no form that is known, or its middleware is not installed.",
        "Write ros1://HOST:PORT, dds://DOMAIN or zenoh://HOST:PORT; the message names the package to install.",
    ),
    "KG802": CodeEntry(
        "robot does not answer",
        "Nothing answers at the address of the robot, or what answers is no ROS master or peer.",
        "See that the robot runs and that the address is right; `kg robot simulate office` starts one to try.",
    ),
    "KG803": CodeEntry(
        "robot is lost",
        "The connection to the robot or to one of its nodes ended, or it did not answer in time.",
        "Go and look whether the robot still moves: that is not known. See that the node runs, then start again.",
    ),
    "KG804": CodeEntry(
        "message type is not known",
        "A message type is not among those that come with kg, and no peer told its definition.",
        "Read the package that defines it with `kg build`, or start the node that publishes it.",
    ),
    "KG805": CodeEntry(
        "value does not fit",
        "A value does not fit the field of the message that it is for.",
        "Give a value of the type that the message names.",
    ),
    "KG806": CodeEntry(
        "types differ",
        "A peer has another definition (MD5 sum, hash or type) of what is exchanged.",
        "Build both sides from the same version of the interface package.",
    ),
    "KG807": CodeEntry(
        "nobody serves it",
        "No node answers the service or action.",
        "Start the node that serves it; `kg robot capabilities --live` lists what there is.",
    ),
    "KG808": CodeEntry(
        "service failed",
        "The node that answers the service says that it failed.",
        "Read the message, which is that node's.",
    ),
    "KG809": CodeEntry(
        "goal was not reached",
        "The action server rejected, aborted or cancelled the goal.",
        "Read the status; try a goal that can be reached.",
    ),
    "KG810": CodeEntry(
        "peer breaks the protocol",
        "A peer sent what its protocol does not allow: a header without end, a message too large, broken XML.",
        "The peer is left out; look at the node that the message names.",
    ),
    "KG818": CodeEntry(
        "robot does not have the capability",
        "No node of the system, or of the package, has a capability of that name.",
        "`kg robot capabilities --all` lists what there is, general capabilities too.",
    ),
    "KG845": CodeEntry(
        "server without a robot",
        "This server was started without the address of a robot.",
        "Start it with one: `kg serve --robot ros1://HOST:PORT`; `kg robot simulate office` starts a robot to try.",
    ),
    "KG846": CodeEntry(
        "robot is not connected",
        "The server knows the address of a robot, but is not connected to it at the moment.",
        "See that the robot runs; the server goes on trying, and the page says when it is there.",
    ),
    "KG847": CodeEntry(
        "robot is busy",
        "Something runs already: a robot is moved by one program at a time, or by hand, and not by too many pages.",
        "Stop what runs, or wait until it has ended.",
    ),
    "KG848": CodeEntry(
        "time for a movement by hand",
        "A movement by hand was to take no time, or longer than somebody can be expected to look on.",
        "Name a shorter time, or write a program.",
    ),
    "KG849": CodeEntry(
        "page is not listening",
        "What is done by hand, or followed, belongs to a page that is open, and this one is not, or not any more.",
        "Load the page again.",
    ),
    "KG811": CodeEntry(
        "node is dead",
        "The master of ROS 1 still lists a node that does not answer: it ended without saying so, or it hangs.",
        "Start the node again, or let `rosnode cleanup` take it off the master's list.",
    ),
    "KG812": CodeEntry(
        "no name of ROS",
        "A name, type or address that a node uses or tells is none by the rules of ROS 1.",
        "Correct the name; what is under it is left out of the computation graph.",
    ),
    "KG813": CodeEntry(
        "peer refuses a call",
        "The master or a node of ROS 1 answered a call with an error of its own.",
        "Read the message, which is that of the peer.",
    ),
    "KG814": CodeEntry(
        "own node cannot be reached",
        "The address that $ROS_HOSTNAME or $ROS_IP names is not one of this machine, so that no peer could connect.",
        "Set ROS_IP to an address of this machine on the network of the robot, or unset both.",
    ),
    "KG815": CodeEntry(
        "quality of service does not fit",
        "Two ends of a topic of ROS 2 are not connected, since one asks for more than the other offers.",
        "Give both ends the same reliability, durability, deadline and liveliness.",
    ),
    "KG816": CodeEntry(
        "peer of ROS 2 tells nonsense",
        "A name that is none, a discovery message that is broken, or a message that does not decode.",
        "It is left out; look at the node that the message names, and at the version of its interface package.",
    ),
    "KG817": CodeEntry(
        "system of ROS 2 cannot be joined",
        "The library of the middleware cannot open the domain or the session, as without a network.",
        "See to the network, and to $CYCLONEDDS_URI or the router that the address names.",
    ),
    "KG820": CodeEntry(
        "robot did not move",
        "A robot was told a velocity, and measured none. A drone that has landed ignores velocities, as does a base "
        "whose motors are off, whose emergency stop is pressed, or that something blocks.",
        "Let a drone take off first (`kg robot do takingOff`); switch motors on; look at the robot.",
    ),
    "KG821": CodeEntry(
        "robot has no such capability",
        "No capability of the robot has this name, label or alternative label.",
        "`kg robot capabilities --live` lists what the robot can do.",
    ),
    "KG822": CodeEntry(
        "no way to the capability",
        "Nothing of the robot offers the capability, or not in the way that was named, or it is read and not done.",
        "`kg robot capabilities --live` shows by which topics, services and actions each capability is reached.",
    ),
    "KG823": CodeEntry(
        "argument is refused",
        "A parameter of a capability is not known, lacks its value, or was given one of another kind or unit, out of "
        "its limits, or none of its choices.",
        "Give a value as the message says; values are never moved into the limits.",
    ),
    "KG824": CodeEntry(
        "nobody listens",
        "A command was to be sent to a topic that no node subscribes to, or does not any more.",
        "Start the node that listens there; a movement that was going on was ended.",
    ),
    "KG825": CodeEntry(
        "not done in time",
        "No message came in time, or a goal was not reached in time; the goal was cancelled.",
        "See that the node works, or allow more time.",
    ),
    "KG826": CodeEntry(
        "path to a field is wrong",
        "The path that leads from a parameter to a field of a message cannot be read, or does not fit the message.",
        "Correct `rnkg:field` in the ontology; the message says what is wrong.",
    ),
    "KG827": CodeEntry(
        "moved by something else",
        "A part of the robot is moved already through another topic or action, and two would tear at it.",
        "Stop what moves it, or wait until that has ended; what moves which part stands in the ontology.",
    ),
    "KG828": CodeEntry(
        "controller stood still",
        "The process that drives the robot was suspended, blocked or killed. Its watchdog stopped the robot: zero "
        "velocity to every topic that moved, and every goal was cancelled.",
        "Nothing goes on by itself: give the command again. On a busy machine, allow more silence: `KG_WATCHDOG=2`.",
    ),
    "KG829": CodeEntry(
        "another controller",
        "Another node publishes velocities to the same topic: a second `kg`, a joystick, navigation. A base follows "
        "both by turns.",
        "Stop the other node, or be refused in such a case: `--exclusive`.",
    ),
    "KG830": CodeEntry(
        "program cannot be read",
        "The text of a program does not follow the language.",
        "Correct it at the place; docs/programs.md shows the language.",
    ),
    "KG831": CodeEntry(
        "program is no tree",
        "The JSON of a program does not follow its schema.",
        "Compare it with docs/program.schema.json at the path that the message names.",
    ),
    "KG832": CodeEntry(
        "program asks for what the robot has not",
        "A program names a capability or a parameter that the robot does not have, or gives one a value that it lacks.",
        "`kg robot capabilities` lists what there is, with its parameters.",
    ),
    "KG833": CodeEntry(
        "kinds or units do not fit",
        "A program mixes values that do not go together: metres with seconds, a text where a number is needed.",
        "Give a value of the kind and unit that the message names.",
    ),
    "KG834": CodeEntry(
        "read and write are mixed up",
        "A program does what can only be sensed, or reads what can only be done.",
        "Write `nearest of laserScanning` for what is sensed, and a statement of its own for what is done.",
    ),
    "KG835": CodeEntry(
        "value is out of bounds",
        "A program gives a value that is not within the limits, or among the choices, of a parameter.",
        "Give a value within the limits.",
    ),
    "KG836": CodeEntry(
        "program does not hold together",
        "A variable is used before it has a value, `break` stands outside a loop, a loop never waits or parts collide.",
        "Mend the block that the message names.",
    ),
    "KG837": CodeEntry(
        "program took too long",
        "A program, or a wait in it, did not end within its time, or it did too much without waiting.",
        "Give it more time (`within`), or let its loops wait.",
    ),
    "KG838": CodeEntry(
        "program failed",
        "A statement could not be carried out with the values that it met; the robot was stopped.",
        "Look at the block that the message names.",
    ),
    "KG839": CodeEntry(
        "program cannot be converted",
        "There is no way to the capability from which code could be made.",
        "Convert it for a robot (`--robot`, `--launch`) that has the capability.",
    ),
    "KG840": CodeEntry(
        "simulation is not installed",
        "Worlds need pybullet and OpenCV, which are not part of a plain installation.",
        "Install the extra: `pip install 'kg-ros[simulate]'`.",
    ),
}
