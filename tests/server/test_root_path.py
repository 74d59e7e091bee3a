"""The server behind a reverse proxy that publishes it at a path: `--root-path /kg`."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import parse_qsl, urljoin, urlsplit

import pytest
from listing import PAGES, shown
from serving import ADDRESS, EVERYWHERE, TOKEN, application, served
from w3c import put

from kg.errors import UsageError
from kg.forms import FormError, root_path
from kg.server import rendering
from kg.store.layout import create

if TYPE_CHECKING:
    from collections.abc import Iterator

    from browsing import Chromium
    from starlette.testclient import TestClient

_ROOT: Final = "/kg"
_ATTRIBUTES: Final = {"href", "src", "action", "data-why", "data-part"}
_POSTED: Final = {"/kg/logout"}
"""Addresses without GET."""
_OTHERS: Final = {"/kg/why": 400}
"""Addresses whose status differs from 200: forms without their fields."""
_LINKS: Final = "[...document.querySelectorAll('a[href]')].map((link) => link.href)"
_WRONG: Final = ("missing", "misspelt", "wrong filter")
"""Pages of the tests that return an error."""
_ELSEWHERE: Final = re.compile(r"""\b(?:href|src|action)=["']/""")


@dataclass
class Proxy:
    """A small reverse proxy: it publishes a server at `/kg`, and optionally strips that from requests."""

    client: TestClient
    strips: bool

    def get(self, path: str, accept: str = "text/html") -> Any:
        """Request a public address, which has the root path."""
        assert path == _ROOT or path.startswith(f"{_ROOT}/"), f"{path} leads past the proxy"
        forwarded = (path.removeprefix(_ROOT) or "/") if self.strips else path
        return self.client.get(forwarded, headers={"Accept": accept})


@dataclass
class Addresses(HTMLParser):
    """The addresses of this server in a page: of links, forms, scripts, styles, pictures and proofs."""

    found: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, _tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the addresses in the attributes of an element."""
        self.found.update(value for name, value in attrs if name in _ATTRIBUTES and value and value.startswith("/"))


@pytest.fixture(scope="module")
def published(browser: Chromium, store: Path) -> Iterator[str]:  # noqa: ARG001 - no server without a browser
    """The public address of a server in a process of its own."""
    with served(store, root_path=_ROOT, log="off") as server:
        yield server.address


@pytest.fixture(scope="module")
def keeping(store: Path) -> Iterator[Proxy]:
    """A server behind a proxy that forwards paths unchanged."""
    with application(store, root_path=_ROOT, log="off") as client:
        yield Proxy(client, strips=False)


@pytest.fixture(params=["kept", "stripped"])
def proxy(request: pytest.FixtureRequest, keeping: Proxy) -> Proxy:
    """Each kind of proxy in front of one server."""
    return Proxy(keeping.client, strips=request.param == "stripped")


def _seeds(proxy: Proxy) -> list[str]:
    """Return the public address of every tested page."""
    things = shown(proxy.client)
    return [_ROOT + path.format(**things) for name, path in PAGES.items() if not name.endswith(_WRONG)]


def _parts(address: str) -> set[tuple[str, str]]:
    """Return the path of an address with each of its parameters, and with none."""
    parts = urlsplit(address)
    return {(parts.path, name) for name, _ in [("", ""), *parse_qsl(parts.query)]}


def test_every_link_stays_below_the_root_path(keeping: Proxy) -> None:
    """Each link with another path or parameter leads to a response through the proxy, and no address bypasses it."""
    waiting, seen, answers = _seeds(keeping), set[tuple[str, str]](), dict[str, int]()
    while waiting:
        address = waiting.pop()
        assert address.startswith((f"{_ROOT}/", f"{_ROOT}?")) or address == _ROOT
        if _parts(address) <= seen:
            continue
        seen |= _parts(address)
        answer = keeping.get(address)
        while answer.is_redirect:
            answer = keeping.get(urljoin(address, answer.headers["location"]))
        answers[address] = answer.status_code
        if "text/html" in answer.headers.get("content-type", ""):
            page = Addresses()
            page.feed(answer.text)
            waiting += sorted(page.found - _POSTED)
    assert {address: status for address, status in answers.items() if status != _OTHERS.get(address, 200)} == {}
    assert {"/kg/openapi.json", "/kg/static/kg.css", "/kg/node/graph.svg", "/kg/api/why", "/kg/errors/KG401"} <= {
        path for path, _ in seen
    }


@pytest.mark.parametrize("address", ["/kg", "/kg/", "/kg/nodes?q=scan", "/kg/static/kg.css", "/kg/api/overview"])
def test_both_kinds_of_proxies_get_the_same(keeping: Proxy, address: str) -> None:
    """A proxy may or may not strip the root path; responses are the same."""
    stripping = Proxy(keeping.client, strips=True)
    assert keeping.get(address).text == stripping.get(address).text


def test_templates_have_no_address_without_the_root_path() -> None:
    """Each address in a template comes from `url`, even if no page of the tests shows it."""
    templates = sorted((Path(rendering.__file__).parent / "templates").glob("*.html"))
    assert templates
    assert [path.name for path in templates if _ELSEWHERE.search(path.read_text("utf-8"))] == []


@pytest.mark.parametrize(
    "name", ["query, rows", "rule made of blocks, of a rule", "robot, none connected", "system", "start"]
)
def test_scripts_stay_below_the_root_path(browser: Chromium, published: str, keeping: Proxy, name: str) -> None:
    """Files loaded and requested by scripts of a page exist below the root path."""
    address = published + PAGES[name].format(**shown(keeping.client))

    async def look() -> tuple[list[str], list[str], list[str]]:
        async with browser.visit(address, kept=True) as visit:
            links = await visit.page.evaluate(
                "[...document.querySelectorAll('a[href], [data-why]')].map((one) => one.href || one.dataset.why)"
            )
            return visit.requests, await visit.troubles(), links

    requests, troubles, links = browser.run(look())
    assert troubles == []
    origin = published.removesuffix(_ROOT)
    assert [one for one in (*requests, *links) if one.startswith(origin) and not one.startswith(f"{published}/")] == []


def test_errors_lead_to_their_explanation(proxy: Proxy) -> None:
    """`type` and `docs` of a problem are addresses below the root path."""
    problem = proxy.get("/kg/sparql?query=SELECT", accept="application/json").json()
    assert problem["type"] == problem["docs"]
    assert proxy.get(problem["docs"]).status_code == 200


def test_the_service_description_names_the_public_address(proxy: Proxy) -> None:
    """The description names the endpoint published by the proxy."""
    text = proxy.get("/kg/sparql", accept="application/n-triples").text
    assert f"<http://www.w3.org/ns/sparql-service-description#endpoint> <{ADDRESS}/kg/sparql>" in text


def test_openapi_names_the_root_path(proxy: Proxy) -> None:
    """The OpenAPI description names the root path as its server."""
    assert proxy.get("/kg/openapi.json").json()["servers"] == [{"url": "/kg"}]


def test_the_rest_of_an_answer_is_below_the_root_path(proxy: Proxy) -> None:
    """`Link` to the next rows can be followed unchanged."""
    answer = proxy.get("/kg/sparql?query=SELECT+*+%7B+%3Fs+%3Fp+%3Fo+%7D&limit=1", accept="text/csv")
    following = answer.headers["link"].partition("<")[2].partition(">")[0]
    assert proxy.get(following, accept="text/csv").status_code == 200


def test_a_slash_too_many_is_redirected(proxy: Proxy) -> None:
    """The redirect to an address without its trailing slash keeps the root path and the parameters."""
    assert proxy.get("/kg/nodes/?q=scan").headers["location"] == "/kg/nodes?q=scan"


def test_logging_in_leads_back(store: Path) -> None:
    """Without the token a page redirects to the form, which leads back to it, with a cookie for the root path."""
    with application(store, root_path=_ROOT, host=EVERYWHERE, token=TOKEN, log="off") as client:
        refused = client.get("/kg/nodes?q=scan", headers={"Accept": "text/html"})
        assert refused.headers["location"] == "/kg/login?next=%2Fnodes%3Fq%3Dscan"
        form = client.post("/kg/login", data={"token": TOKEN, "next": "/nodes?q=scan"})
        assert form.headers["location"] == "/kg/nodes?q=scan"
        assert "; Path=/kg;" in form.headers["set-cookie"]
        assert client.get(form.headers["location"]).status_code == 200


@pytest.fixture(scope="module")
def guarded(store: Path) -> Iterator[TestClient]:
    """A client without the token of a writable server."""
    with application(store, root_path=_ROOT, write=True, token=TOKEN, log="off") as client:
        yield client


@pytest.mark.parametrize("path", ["/kg/update", "/update", "/kg/update/", "/%6bg/update"])
def test_changes_need_the_token_below_the_root_path(guarded: TestClient, path: str) -> None:
    """The root path does not bypass the protection of an address."""
    assert guarded.post(path, data={"update": "CLEAR ALL"}).status_code in {401, 404}


def test_graphs_are_named_by_their_public_address(tmp_path: Path) -> None:
    """A graph created below `/store` is named by its public address."""
    layout = create(tmp_path / ".kg")
    put(layout)
    with application(layout.root, root_path=_ROOT, write=True, token=TOKEN, log="off") as client:
        client.headers["Authorization"] = f"Bearer {TOKEN}"
        made = client.post("/kg/store", content="<urn:a> <urn:b> <urn:c> .", headers={"Content-Type": "text/turtle"})
        assert made.headers["location"].startswith(f"{ADDRESS}/kg/store/")
        assert "<urn:b>" in client.get(made.headers["location"], headers={"Accept": "text/turtle"}).text


def test_a_root_path_like_an_own_address_is_refused(store: Path) -> None:
    """Behind a proxy that strips such a root path, `/query` would be ambiguous."""
    with pytest.raises(UsageError, match="/query/kg begins like an address"), application(store, root_path="/query/kg"):
        pass


@pytest.mark.parametrize(("given", "read"), [("/", ""), ("/kg/", "/kg"), (" /a/b-c ", "/a/b-c")])
def test_forms_of_root_paths(tmp_path: Path, given: str, read: str) -> None:
    """The trailing slash is ignored."""
    assert root_path(given, tmp_path) == read


@pytest.mark.parametrize("given", ["kg", "//kg", "/k g", "/../kg", "/kg?x", "http://example.org/kg", 7])
def test_other_forms_are_refused(tmp_path: Path, given: object) -> None:
    """A path that cannot be compared with request paths is rejected."""
    with pytest.raises(FormError):
        root_path(given, tmp_path)
