"""The filters of `kg search` as options; `kg.search.names` applies them."""

from __future__ import annotations

from typing import Final, NamedTuple


class Filter(NamedTuple):
    """A filter of `kg search`: its name, and its text in `--help`."""

    name: str
    metavar: str
    sentence: str
    code: str
    """The error code for a value that no node in the store has."""


FILTERS: Final = {
    one.name: one
    for one in (
        Filter("subscribes", "TYPE", "Subscribes to it.", "KG701"),
        Filter("publishes", "TYPE", "Publishes it.", "KG701"),
        Filter("services", "TYPE", "Offers the service or action.", "KG701"),
        Filter("calls", "TYPE", "Calls the service or action.", "KG701"),
        Filter("hardware", "NAME", "Works with it.", "KG702"),
        Filter("function", "NAME", "Is for it: navigation, ...", "KG702"),
        Filter("capability", "NAME", "Lets a robot do it.", "KG702"),
        Filter("ros", "1|2", "For this version of ROS.", "KG703"),
        Filter("license", "NAME", "Under it: BSD is any BSD.", "KG703"),
        Filter("kind", "KIND", "executable, script, nodelet, ...", "KG703"),
        Filter("package", "NAME", "Only this package (`name` or `repository:name`).", "KG703"),
    )
}
