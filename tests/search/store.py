"""A small hand-written content: a few nodes of three packages, one of them a copy of another."""

from __future__ import annotations

from typing import Final

from kg.search.documents import Document, End, PackageDocument, Text
from kg.search.reading import Concept, Content

__all__ = ["CONTENT"]


def _scan_to(role: str, kind: str, name: str = "scan") -> End:
    return End(role, name, f"sensor_msgs/{kind}", "src/node.cpp", 12)


_MERGER: Final = Document(
    iri="https://example.org/merger",
    name="scan_merger_node",
    kind="executable",
    package=0,
    ros=1,
    path="src/merger.cpp",
    line=3,
    executable="scan_merger_node",
    texts=(Text("Merges the scans of several lasers.", "comment", "src/merger.cpp", 1),),
    ends=(_scan_to("publishes", "LaserScan"), _scan_to("subscribes", "LaserScan", "front")),
    parameters=(("~/frame_id", "the frame of what is published"),),
    hardware=("laser scanner",),
    functions=("data processing",),
)
_MERGER_NODELET: Final = Document(
    iri="https://example.org/merger-nodelet",
    name="ScanMergerNodelet",
    kind="nodelet",
    package=0,
    ros=1,
    path="src/merger_nodelet.cpp",
    line=5,
    plugin="lasers/ScanMergerNodelet",
    ends=_MERGER.ends,
)
_TO_CLOUD: Final = Document(
    iri="https://example.org/cloud",
    name="scan_to_cloud",
    kind="component",
    package=1,
    ros=2,
    path="src/cloud.cpp",
    line=9,
    plugin="clouds::ScanToCloud",
    ends=(_scan_to("subscribes", "LaserScan"), _scan_to("publishes", "PointCloud2", "cloud")),
    functions=("data processing",),
)
_DRIVER: Final = Document(
    iri="https://example.org/camera",
    name="camera_driver",
    kind="script",
    package=1,
    ros=2,
    path="scripts/camera.py",
    line=1,
    ends=(
        _scan_to("publishes", "Image", "image"),
        End("services", "start", "std_srvs/SetBool", "scripts/camera.py", 8),
    ),
    hardware=("camera",),
    functions=("hardware",),
    capabilities=("see",),
)
_COPY: Final = Document(
    iri="https://example.org/merger-copy",
    name="scan_merger_node",
    kind="executable",
    package=2,
    ros=1,
    path="lasers/src/merger.cpp",
    line=3,
    executable="scan_merger_node",
    texts=_MERGER.texts,
    ends=_MERGER.ends,
)

CONTENT: Final = Content(
    packages=[
        PackageDocument(
            iri="p:lasers",
            repository="example.org/one/lasers",
            name="lasers",
            version="1.2.0",
            ros=1,
            path="package.xml",
            description="Tools for laser scanners.",
            licenses=("BSD", "BSD-3-Clause"),
            copies=("p:vendored",),
        ),
        PackageDocument(
            iri="p:clouds",
            repository="example.org/two/clouds",
            name="clouds",
            ros=2,
            path="package.xml",
            licenses=("Apache-2.0",),
            texts=(
                Text(
                    "Start it with the launch file of the robot, and wait until the light of the motors turns green. "
                    "Then plug in the thermometer, whose readings colour the image.",
                    "usage",
                    "README.md",
                    20,
                    "Steps",
                ),
            ),
        ),
        PackageDocument(
            iri="p:vendored",
            repository="example.org/three/robot",
            name="lasers",
            version="1.0.0",
            ros=1,
            path="lasers/package.xml",
            deprecated=True,
            licenses=("BSD",),
            copies=("p:lasers",),
        ),
    ],
    nodes=[_MERGER, _MERGER_NODELET, _TO_CLOUD, _DRIVER, _COPY],
    concepts=[
        Concept("laser scanner", "hardware", ("lidar", "laser range finder"), ("sensor",)),
        Concept("camera", "hardware", ("webcam",), ("sensor",)),
        Concept("sensor", "hardware"),
        Concept("data processing", "function", ("filtering",)),
        Concept("hardware", "function", ("driver",)),
        Concept("see", "capability"),
    ],
)
