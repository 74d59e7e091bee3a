"""Content of sources is plain text on every page, even if it looks like markup (C27)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from urllib.parse import quote
from xml.sax.saxutils import escape

import httpx
import pytest
from patience import patient
from serving import served

from kg.pipeline.build import build
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from browsing import Chromium

_SCRIPT: Final = "window.kgBroken=1"
_BREAKS: Final = ('"', "'", "", "-->", "]]>", "</title>", "</textarea>", "</style>", "</script>")
_LOADED: Final = ("img", "video", "audio", "iframe", "embed")
_FOCUSED: Final = ("input", "select", "textarea", "button", "a", "div")
_EVENTS: Final = ("onmouseover", "onclick", "onfocus", "onanimationstart", "ontoggle")
HOSTILE: Final = (
    *(f"<{tag} src=x {event}={_SCRIPT}>" for tag in _LOADED for event in ("onerror", "onload")),
    *(f"<{tag} onfocus={_SCRIPT} autofocus tabindex=0>" for tag in _FOCUSED),
    *(f"{text}><script>{_SCRIPT}</script>" for text in _BREAKS),
    *(f'"{event}="{_SCRIPT}" x="' for event in _EVENTS),
    f"<svg onload={_SCRIPT}>",
    f"<svg><script>{_SCRIPT}</script></svg>",
    f"<math><mtext><img src=x onerror={_SCRIPT}></mtext></math>",
    f"<details open ontoggle={_SCRIPT}>x</details>",
    f"<body onload={_SCRIPT}>",
    f"<object data=javascript:{_SCRIPT}>",
    f"<form action=javascript:{_SCRIPT}><button>x</button></form>",
    f"<a href=javascript:{_SCRIPT}>x</a>",
    f"javascript:{_SCRIPT}",
    f"JaVaScRiPt:{_SCRIPT}",
    f"data:text/html,<script>{_SCRIPT}</script>",
    f"vbscript:{_SCRIPT}",
    f"<meta http-equiv=refresh content='0;url=javascript:{_SCRIPT}'>",
    "<link rel=stylesheet href=//evil.example/x.css>",
    "<base href=//evil.example/>",
    "<style>*{background:url(//evil.example/x)}</style>",
    "{{ 7 * 7 }}{% raw %}",
    "${7*7}<%= 7*7 %>",
    "\u202e<script>\u202c",
    "&lt;script&gt;&amp;&#60;img src=x&#62;",
)
"""Texts that a page must show literally."""

_INJECTED: Final = """() => {
  const all = [...document.querySelectorAll("*")];
  const address = (one) => one.getAttribute("href") ?? one.getAttribute("action") ?? one.getAttribute("src") ?? "";
  const found = [
    ...all.filter((one) => [...one.attributes].some(({ name }) => name.startsWith("on"))),
    ...document.querySelectorAll("script:not([src], [type='importmap'], [type='application/json'])"),
    ...document.querySelectorAll("base, meta[http-equiv], iframe, object, embed"),
    ...all.filter((one) => /^\\s*(javascript|data|vbscript):/i.test(address(one))),
  ];
  return found.map((one) => one.outerHTML.slice(0, 200)).concat(window.kgBroken ? ["a script ran"] : []);
}"""


@pytest.fixture(scope="module")
def hostile(browser: Chromium, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:  # noqa: ARG001 - no server without a browser
    """The address of a server for a package whose names, descriptions, topics and parameters are all hostile."""
    root = tmp_path_factory.mktemp("hostile")
    _package(root / "source" / "evil")
    build([str(root / "source")], EmbeddedStore.create(root / ".kg"), load({}, environment={}))
    with served(root / ".kg", log="off") as server:
        yield server.address


def _package(folder: Path) -> None:
    """Write a package with one node."""
    (folder / "scripts").mkdir(parents=True)
    (folder / "launch").mkdir()
    words = " ".join(HOSTILE)
    (folder / "package.xml").write_text(
        f"""<package format="2"><name>evil</name><version>1.0.0</version><description>{escape(words)}</description>
        <maintainer email="a@b.example">{escape(HOSTILE[0])}</maintainer><license>{escape(HOSTILE[1])}</license>
        <url>javascript:{_SCRIPT}</url><buildtool_depend>catkin</buildtool_depend><depend>rospy</depend></package>""",
        "utf-8",
    )
    (folder / "CMakeLists.txt").write_text("catkin_install_python(PROGRAMS scripts/evil.py)\n", "utf-8")
    lines = [f"    rospy.Publisher({text!r}, String, queue_size=1)" for text in HOSTILE]
    lines += [f"    rospy.get_param('~p{number}', {text!r})" for number, text in enumerate(HOSTILE)]
    body = "\n".join(lines)
    node = folder / "scripts" / "evil.py"
    node.write_text(
        f'#!/usr/bin/env python\n"""{HOSTILE[0]} lidar driver."""\nimport rospy\nfrom std_msgs.msg import String\n\n\n'
        f"def main():\n    rospy.init_node('evil')\n{body}\n\n\nmain()\n",
        "utf-8",
    )
    node.chmod(0o755)
    (folder / "launch" / "evil.launch").write_text(
        '<launch><node pkg="evil" type="evil.py" name="evil"><param name="p0" value="'
        f'{escape(HOSTILE[0], {chr(34): "&quot;"})}"/></node></launch>',
        "utf-8",
    )


def _addresses(site: str) -> dict[str, str]:
    """Return the pages that show data of the package."""
    with httpx.Client(base_url=site, timeout=patient(30)) as client:
        (hit, *_) = client.get("/api/find", params={"text": "evil"}).json()["hits"]
    rows = " ".join("'''" + text.replace("\\", "\\\\").replace("'", "\\'") + "'''" for text in HOSTILE)
    query = f"SELECT ?x {{ VALUES ?x {{ {rows} <javascript:{_SCRIPT}> <data:text/html,x> }} }}"
    return {
        "start": "/",
        "search": "/search?q=evil",
        "search for it": f"/search?q={quote(HOSTILE[0])}",
        "filter by it": f"/search?q=evil&hardware={quote(HOSTILE[10])}",
        "a page that is not there": f"/{quote(HOSTILE[0], safe='')}",
        "a rule that is not there": f"/rule?name={quote(HOSTILE[0])}",
        "node": f"/node?iri={quote(hit['iri'], safe='')}",
        "resource": f"/resource?iri={quote('javascript:' + _SCRIPT, safe='')}",
        "systems": "/systems",
        "nodes": "/nodes",
        "parameters": "/parameters",
        "system": f"/system?name={quote('evil/launch/evil.launch', safe='')}",
        "query": f"/query?query={quote(query)}",
        "why": f"/why?subject={quote(HOSTILE[0])}&predicate=a&object={quote(HOSTILE[1])}",
    }


def test_nothing_of_the_data_becomes_markup(browser: Chromium, hostile: str) -> None:
    """Data runs no script, creates no element, links to no script, and causes no request to another host."""

    async def look(path: str) -> list[str]:
        async with browser.visit(hostile + path, kept=True) as visit:
            await visit.page.keyboard.press("Tab")
            injected: list[str] = await visit.page.evaluate(_INJECTED)
            said = [one for one in await visit.troubles() if "Failed to load resource" not in one]
            return [*injected, *said]

    found = {name: browser.run(look(path)) for name, path in _addresses(hostile).items()}
    assert {name: what for name, what in found.items() if what} == {}


def test_hostile_words_are_shown(browser: Chromium, hostile: str) -> None:
    """A page shows the words literally as in the source."""

    async def text(path: str) -> str:
        async with browser.visit(hostile + path, kept=True) as visit:
            return await visit.page.inner_text("main")

    assert HOSTILE[0] in browser.run(text("/search?q=evil"))
    assert HOSTILE[10] in browser.run(text(f"/search?q={quote(HOSTILE[10])}"))


def test_there_are_fifty() -> None:
    """The number of hostile texts is that of the guarantee."""
    assert len(set(HOSTILE)) >= 50
