"""The filters of `kg search` as options; `kg.search.names` applies them."""

from __future__ import annotations

from typing import Final, NamedTuple


class Filter(NamedTuple):
    """A filter of `kg search`: its name, its label on the page, and its text in `--help`."""

    name: str
    label: str
    metavar: str
    sentence: str
    code: str
    """The error code for a value that no node in the store has."""
    roles: tuple[str, ...] = ()
    """The roles of the interfaces whose type it names."""


FILTERS: Final = {
    one.name: one
    for one in (
        Filter("subscribes", "Subscribes to", "TYPE", "Subscribes to it.", "KG701", ("subscribes",)),
        Filter("publishes", "Publishes", "TYPE", "Publishes it.", "KG701", ("publishes",)),
        Filter(
            "services",
            "Offers service or action",
            "TYPE",
            "Offers the service or action.",
            "KG701",
            ("services", "action_servers"),
        ),
        Filter(
            "calls",
            "Calls service or action",
            "TYPE",
            "Calls the service or action.",
            "KG701",
            ("clients", "action_clients"),
        ),
        Filter("hardware", "Works with hardware", "NAME", "Works with it.", "KG702"),
        Filter("function", "Function", "NAME", "Is for it: navigation, ...", "KG702"),
        Filter("capability", "Capability", "NAME", "Lets a robot do it.", "KG702"),
        Filter("ros", "ROS version", "1|2", "For this version of ROS.", "KG703"),
        Filter("license", "Licence", "NAME", "Under it: BSD is any BSD.", "KG703"),
        Filter("kind", "Kind", "KIND", "executable, script, nodelet, ...", "KG703"),
        Filter("package", "In package", "NAME", "Only this package (`name` or `repository:name`).", "KG703"),
    )
}
