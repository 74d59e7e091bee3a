"""What stops when: the time from an event to the zero velocity that the robot gets, over ROS 1, DDS and bridges.

    python -m benchmarks.stopping [--repeats N] [--seconds S] [--over PROTOCOL]... [--event EVENT]... [--by DRIVER]...
    unshare -n sh -c 'ip link set lo up; python -m benchmarks.stopping --cut'

`--cut` takes the network away in some rows. `unshare` (as root) gives the benchmark a network of its own for that. The
robot is on this host, and a routing rule drops everything; over DDS it is on another host, and its cable is pulled.
A command line (`kg robot do`), a program (`kg robot run`) or a page (`kg serve`) drives a robot in a process of its
own; then something happens. A row has the least and the greatest seconds, or `no zero` if none came in `--seconds`.
"""

from __future__ import annotations

import argparse
import json
import os
import queue
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import httpx

ROOT: Final = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from ports import own_port  # noqa: E402 - what tests share is found by the line above
from robot import hosts  # noqa: E402 - as above
from robot.driving import drivable  # noqa: E402 - as above

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from contextlib import AbstractContextManager

TOKEN: Final = "token-of-a-benchmark"  # noqa: S105 - it guards nothing
DO: Final = ("do", "drivingAtVelocity", "forward=0.5", "--for", "600")
RUN: Final = ("run", "endless.kgp")
PROGRAM: Final = "repeat 9 times\n  move at a velocity  forward: 0.5 m/s for 10 min\nend\n"
PROTOCOLS: Final = ("ROS 1", "DDS", "rosbridge", "Foxglove")
ROS1, DDS, ROSBRIDGE, FOXGLOVE = PROTOCOLS
MASTER_STOPPED: Final = "master stopped"
MACHINE_LOST: Final = "machine lost"
BY_HAND: Final = "page, by hand"
PROGRAM_OF_PAGE: Final = "page, program"
SPEED: Final = re.compile(r"(?:speed )?(-?[\d.]+)")
START: Final = 120.0
"""Seconds until a robot that is driven moves."""


class Robot:
    """A robot in a process of its own, and the velocities that it gets as they come."""

    def __init__(self, process: subprocess.Popen[str], address: str = "") -> None:
        self.address = address or _line(process)
        self.cut: Callable[[], AbstractContextManager[None]] = cut
        self._speeds: queue.Queue[tuple[float, float]] = queue.Queue()
        self._stdout = process.stdout or ()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for line in self._stdout:
            if (found := SPEED.fullmatch(line.strip())) is not None:
                self._speeds.put((time.monotonic(), float(found[1])))

    def until(self, speed: float, seconds: float) -> float | None:
        """Return when a speed in m/s came, None when it did not within so many seconds."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            try:
                at, got = self._speeds.get(timeout=left)
            except queue.Empty:
                return None
            if got == speed:
                return at
        return None


def _line(process: subprocess.Popen[str]) -> str:
    """Return the first line that a process prints."""
    return process.stdout.readline().strip() if process.stdout else ""


@contextmanager
def robot(over: str) -> Iterator[Robot]:
    """Run a robot: a node of `kg`, or the peer of a bridge."""
    with ExitStack() as stack:
        address = []
        if over in {ROSBRIDGE, FOXGLOVE}:
            program = Path(__file__).with_name("bridged.py")
            yield Robot(stack.enter_context(_process([str(program), over.lower()])))
            return
        if over == DDS:
            from robot.dds.domain import domain  # noqa: PLC0415 - needs an extra

            address = [f"dds://{stack.enter_context(domain())}?settle=1"]
        yield Robot(stack.enter_context(_process([str(drivable.__file__), *address])))


@contextmanager
def robot_beside_master() -> Iterator[tuple[Robot, Callable[[], object]]]:
    """Run a robot of rospy, and give what ends its master.

    A node of `kg` ends its subscriptions when it loses the master, and may lose it before the controller does. A node
    of rospy keeps its connections.
    """
    from robot.driving.test_debian import ROVER  # noqa: PLC0415 - needs packages of Debian
    from robot.ros1.debian import rosmaster, rospy  # noqa: PLC0415 - as above

    with ExitStack() as master:
        port = master.enter_context(rosmaster())
        with rospy(port, ROVER) as process:
            yield Robot(process, f"ros1://127.0.0.1:{port}"), master.close


@contextmanager
def robot_elsewhere() -> Iterator[Robot]:
    """Run a robot over DDS on another host."""
    with hosts.host("robot") as name, hosts.cable(name, None):
        command = [str(drivable.__file__), "dds://0"]
        with _process(command, before=hosts.on(name)) as process:
            found = Robot(process)
            found.cut = partial(pulled, name)
            yield found


@contextmanager
def _robot(event: str, over: str) -> Iterator[tuple[Robot, Callable[[], object]]]:
    """Run the robot of a case, and give what ends its master, if it has one."""
    if over == ROS1 and (event == MASTER_STOPPED or event in CUTS):
        with robot_beside_master() as (found, end_master):
            yield found, end_master
    elif over == DDS and event in CUTS:
        with robot_elsewhere() as found:
            yield found, lambda: None
    else:
        with robot(over) as found:
            yield found, lambda: None


@contextmanager
def _process(
    arguments: list[str], folder: str | None = None, before: tuple[str, ...] = (), **environment: str
) -> Iterator[subprocess.Popen[str]]:
    """Run Python in a group of processes of its own, which is killed at the end."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("KG_", "ROS_"))}
    paths = os.pathsep.join((str(ROOT), str(ROOT / "tests")))
    with subprocess.Popen(
        [*before, sys.executable, *arguments],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=folder,
        env={**kept, "PYTHONPATH": paths, **environment}, start_new_session=True,
    ) as process:  # fmt: skip
        try:
            yield process
        finally:
            for number in (signal.SIGCONT, signal.SIGKILL):
                _group(process, number)


def _group(process: subprocess.Popen[str], number: signal.Signals) -> None:
    """Send a signal to a process and its children, its watchdog among them."""
    try:
        os.killpg(process.pid, number)
    except ProcessLookupError:
        return


def _with_children(process: subprocess.Popen[str], number: signal.Signals) -> None:
    """Send a signal to a process and all below it, also those in sessions of their own."""
    found, waiting = [process.pid], [process.pid]
    while waiting:
        above = waiting.pop()
        children = Path(f"/proc/{above}/task/{above}/children").read_text("utf-8").split()
        found += map(int, children)
        waiting += map(int, children)
    for one in found:
        os.kill(one, number)


EVENTS: Final[dict[str, Callable[[subprocess.Popen[str]], None]]] = {
    "Ctrl-C (SIGINT)": lambda process: process.send_signal(signal.SIGINT),
    "ended (SIGTERM)": lambda process: process.send_signal(signal.SIGTERM),
    "terminal closed (SIGHUP)": lambda process: process.send_signal(signal.SIGHUP),
    "Ctrl-Z (SIGTSTP)": lambda process: process.send_signal(signal.SIGTSTP),
    "killed (SIGKILL)": lambda process: process.kill(),
    "suspended (SIGSTOP)": lambda process: process.send_signal(signal.SIGSTOP),
    MACHINE_LOST: lambda process: _with_children(process, signal.SIGSTOP),
}


ON_SERVER: Final[dict[str, signal.Signals]] = {
    "server ended (SIGTERM)": signal.SIGTERM,
    "server's terminal closed (SIGHUP)": signal.SIGHUP,
    "server, Ctrl-Z (SIGTSTP)": signal.SIGTSTP,
    "server killed (SIGKILL)": signal.SIGKILL,
    "server suspended (SIGSTOP)": signal.SIGSTOP,
}


CUTS: Final[dict[str, float | None]] = {"network cut": None, "network cut for 3 s": 3.0, "network cut for 10 s": 10.0}
"""How long the network is cut, in seconds; None for as long as is measured."""


@contextmanager
def cut() -> Iterator[None]:
    """Take the network away: nothing has a route, and interfaces stay as they are, as behind a switch that fails."""
    _rule("add", "pref", "1", "type", "blackhole")
    try:
        yield
    finally:
        _rule("del", "pref", "1")


@contextmanager
def pulled(name: str) -> Iterator[None]:
    """Pull the cable of a host."""
    hosts.plug(name, "down")
    try:
        yield
    finally:
        hosts.plug(name, "up")


def _rule(*arguments: str) -> None:
    subprocess.run(["ip", "rule", *arguments], check=True)


def _cut(found: Robot, begun: float, event: str, seconds: float) -> float | None:
    """Cut the network as long as the event says, and return the seconds from `begun` to zero."""
    with found.cut():
        at = found.until(0, CUTS[event] or seconds)
    return since(found, begun, seconds) if at is None and CUTS[event] else _after(at, begun)


def _of_command(command: tuple[str, ...], event: str, seconds: float, over: str) -> float | None:
    """Return the seconds from an event of a command to zero."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        found, end_master = stack.enter_context(_robot(event, over))
        (Path(folder) / "endless.kgp").write_text(PROGRAM, "utf-8")
        arguments = ["-m", "kg", "robot", *command, "--robot", found.address]
        process = stack.enter_context(_process(arguments, folder))
        moving(found)
        begun = time.monotonic()
        if event == MASTER_STOPPED:
            end_master()
        elif event in CUTS:
            return _cut(found, begun, event, seconds)
        else:
            EVENTS[event](process)
        return since(found, begun, seconds)


def _of_page(how: str, event: str, seconds: float, over: str) -> float | None:
    """Return the seconds from an event to zero of a page that drives by hand, or runs a program."""
    with ExitStack() as stack, tempfile.TemporaryDirectory() as folder:
        found, end_master = stack.enter_context(_robot(event, over))
        port = stack.enter_context(own_port())
        arguments = ["-m", "kg", "serve", "--robot", found.address, "--port", str(port)]
        server = stack.enter_context(_process(arguments, folder, KG_TOKEN=TOKEN))
        client = stack.enter_context(_client(port))
        page = stack.enter_context(ExitStack())
        listener = page.enter_context(_listening(client))
        if how == PROGRAM_OF_PAGE:
            client.post("/robot/run", json={"text": PROGRAM}).raise_for_status()
        else:
            body = {"listener": listener, "capability": "drivingAtVelocity", "seconds": 60}
            client.post("/robot/do", json={**body, "arguments": {"forward": 0.5}}).raise_for_status()
        beat = page.enter_context(_beat(port, listener))
        moving(found)
        begun = time.monotonic()
        if event == "STOP pressed":
            client.post("/robot/stop")
        elif event == "page silent":
            beat.set()
            begun = time.monotonic()
        elif event == "page closed":
            page.close()
            begun = time.monotonic()
        elif event == MASTER_STOPPED:
            end_master()
        elif event in CUTS:
            return _cut(found, begun, event, seconds)
        elif event == MACHINE_LOST:
            _with_children(server, signal.SIGSTOP)
        else:
            server.send_signal(ON_SERVER[event])
        return since(found, begun, seconds)


@contextmanager
def _listening(client: httpx.Client) -> Iterator[str]:
    """Listen to the events of the robot as a page does; give the identity of the listener once the robot is there."""
    listener = ""
    with client.stream("GET", "/robot/events") as events:
        lines = events.iter_lines()  # kept: who lets go of it closes the stream
        for line in lines:
            told = json.loads(line.removeprefix("data: ")) if line.startswith("data: ") else {}
            listener = told.get("listener", listener)
            if listener and client.get("/api/robot").json()["state"] == "connected":
                break
        yield listener


@contextmanager
def _beat(port: int, listener: str) -> Iterator[threading.Event]:
    """Send the page's sign of life each second until the event is set."""
    ended = threading.Event()

    def beat() -> None:
        headers = {"Authorization": f"Bearer {TOKEN}"}
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", headers=headers, timeout=1) as client:
            while not ended.wait(1):
                with suppress(httpx.HTTPError):
                    client.post("/robot/here", json={"listener": listener})

    thread = threading.Thread(target=beat)
    thread.start()
    try:
        yield ended
    finally:
        ended.set()
        thread.join()


@contextmanager
def _client(port: int) -> Iterator[httpx.Client]:
    """Give a client, once the server answers."""
    headers = {"Authorization": f"Bearer {TOKEN}"}
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", headers=headers, timeout=60) as client:
        end = time.monotonic() + START
        while True:
            try:
                client.get("/api/robot").raise_for_status()
                break
            except httpx.HTTPError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.1)
        yield client


def moving(found: Robot) -> None:
    """Wait until the robot has moved for as long as the watchdog takes to start; TimeoutError when it does not."""
    for _ in range(50):  # five seconds
        if found.until(0.5, START) is None:
            raise TimeoutError("the robot does not move")


def since(found: Robot, begun: float, seconds: float) -> float | None:
    """Return the seconds from `begun` to zero."""
    return _after(found.until(0, seconds), begun)


def _after(at: float | None, begun: float) -> float | None:
    return None if at is None else at - begun


def main() -> None:
    """Measure each case, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=8.0)
    parser.add_argument("--over", action="append", choices=PROTOCOLS)
    parser.add_argument("--cut", action="store_true", help="cut the network of this process, which has to be its own")
    parser.add_argument("--event", action="append", help="only rows of this event, by its name in the table")
    parser.add_argument("--by", action="append", help="only rows of this driver, by its name in the table")
    given = parser.parse_args()
    if given.cut:  # make room for a rule before that of local addresses
        _rule("add", "pref", "100", "lookup", "local")
        _rule("del", "pref", "0")
    over = given.over or PROTOCOLS
    print(f"| event | driven by | {' | '.join(over)} |\n|---|---|{'---|' * len(over)}")
    events = [*EVENTS, *(CUTS if given.cut else ()), MASTER_STOPPED]
    commands = [(event, command) for event in events for command in (DO, RUN)]
    pages = ("page closed", "page silent", "STOP pressed", *ON_SERVER, MACHINE_LOST, *events[len(EVENTS) :])
    cases: list[tuple[str, str, Callable[[str], float | None]]] = [
        (event, f"`kg robot {command[0]}`", partial(_of_command, command, event, given.seconds))
        for event, command in commands
    ]
    cases += [
        (event, how, partial(_of_page, how, event, given.seconds))
        for event in pages
        for how in (BY_HAND, PROGRAM_OF_PAGE)
    ]
    for event, name, measure in cases:
        if (given.event and event not in given.event) or (given.by and name not in given.by):
            continue
        cells = []
        for one in over:
            if event == MASTER_STOPPED and one != ROS1:
                cells.append("no master")
                continue
            times = [measure(one) for _ in range(given.repeats)]
            known = sorted(one for one in times if one is not None)
            cells.append(f"{known[0]:.2f} to {known[-1]:.2f} s" if len(known) == len(times) else "no zero")
        print(f"| {event} | {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
