"""Plugin descriptions of pluginlib and nodelet (wiki.ros.org/pluginlib/PluginDescriptionFile)."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING, Final

from kg.extract.buildmodel import PluginClass, Registration, Target
from kg.extract.manifests.package_xml import flat_text
from kg.facts import FileKind, Location
from kg.xmltext import line_of, parse_xml

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from lxml.etree import _Element

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader

_ROOTS: Final = frozenset({"library", "class_libraries"})
_REGISTRATIONS: Final = {
    "nodelet::Nodelet": Registration.NODELET,
    "rclcpp_components::NodeFactory": Registration.COMPONENT,
    "rclcpp::Node": Registration.COMPONENT,
}
_TEMPLATE: Final = re.compile(rb"""=\s*(?:"[^"&]*"|'[^'&]*')""")
"""Attribute values without entities; pluginlib's parser takes `type="filters::Mean<double>"` as it stands."""


def exported_files(
    folder: PackageFolder, exports: Iterable[tuple[str, dict[str, str], str, int]], listed: Iterable[str]
) -> list[str]:
    """Return the plugin descriptions of a package: those its manifest or CMake export and those named like one."""
    files: dict[str, None] = {}
    for _, attributes, _, _ in exports:
        written = attributes.get("plugin")
        if written:
            relative = written.replace("${prefix}", "").replace("$(prefix)", "").lstrip("/")
            files[posixpath.normpath(folder.join(relative))] = None
    files.update(dict.fromkeys(listed))
    files.update((entry.path, None) for entry in folder.files if entry.kind is FileKind.PLUGIN)
    return list(files)


def read_plugin_file(reader: Reader, path: str, targets: Iterable[Target]) -> Iterator[PluginClass]:
    """Yield the classes a description declares; files that exist not or are something else yield nothing."""
    if reader.workspace.entry(reader.file(path)) is None:
        return
    text = reader.read(path)
    if text is None or (b"<library" not in text and b"<class" not in text):
        return
    result = parse_xml(_single_root(text))
    if result.problem:
        result = parse_xml(_single_root(_TEMPLATE.sub(lambda match: match[0].replace(b"<", b"&lt;"), text)))
    if result.problem:
        code, message, line = result.problem
        reader.problem(code, f"the plugin description {message}", path, line)
    if result.root is None or result.root.tag not in _ROOTS:
        return
    names = {name: target.name for target in targets for name in (target.name, target.output_name) if name}
    for library in result.root.iter("library"):
        name = _library(str(library.get("path") or ""), names)
        for element in library.iter("class"):
            plugin = _plugin(element, name, path)
            if plugin:
                yield plugin


def _single_root(text: bytes) -> bytes:
    """Return the text with one root: descriptions with several libraries in a row are read by pluginlib too."""
    if text.count(b"<library") < 2 or b"<class_libraries" in text:  # noqa: PLR2004  (one library is a root by itself)
        return text
    start = text.index(b"<library")
    return text[:start] + b"<class_libraries>" + text[start:] + b"</class_libraries>"


def _plugin(element: _Element, library: str | None, path: str) -> PluginClass | None:
    kind = str(element.get("type") or element.get("name") or "").strip()
    if not kind:
        return None
    base = str(element.get("base_class_type") or element.get("base_class") or "").strip() or None
    description = element.find("description")
    return PluginClass(
        name=str(element.get("name") or kind).strip(),
        type=kind,
        registration=_REGISTRATIONS.get(base or "", Registration.PLUGIN),
        location=Location(path, line_of(element)),
        base_type=base,
        library=library,
        description=(flat_text(description) or None) if description is not None else None,
    )


def _library(written: str, names: dict[str, str]) -> str | None:
    """Return the target that makes the library at a path (`lib/libfoo`), else the name without folder and `lib`."""
    base = posixpath.basename(written.strip().rstrip("/")).removesuffix(".so")
    plain = base.removeprefix("lib")
    for name in (plain, base):
        if name in names:
            return names[name]
    return plain or None
