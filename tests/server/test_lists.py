"""Tests of the pages that list all entities of a kind, as seen by programs and browsers without scripts."""

from __future__ import annotations

import csv
import json
import re
from html import unescape
from typing import TYPE_CHECKING
from urllib.parse import unquote_plus

import pytest

from kg.views.lists import LISTS

if TYPE_CHECKING:
    from starlette.testclient import TestClient

_EVERY = pytest.mark.parametrize("name", LISTS)


@_EVERY
def test_exports_have_all_rows(client: TestClient, name: str) -> None:
    """JSON, JSON Lines and CSV have as many rows as the page reports, however many it shows."""
    told = client.get(f"/{name}", headers={"Accept": "application/json"}).json()
    lines = client.get(f"/{name}?format=jsonl").text.splitlines()
    table = list(csv.DictReader(client.get(f"/{name}?format=csv").text.splitlines()))
    assert [json.loads(line) for line in lines] == told["rows"]
    assert len(table) == len(lines) == told["total"] > 0


def test_few_values_of_a_filter_are_links(client: TestClient) -> None:
    """Each value has its number of rows, the chosen one is marked, and other filters and words stay."""
    text = client.get("/nodes?kind=script&q=rover&package=rover_robot").text
    found = re.findall(
        r'<a href="([^"]+)"( aria-current="true")?>([^<]+) <span class="quiet-text">(\d+)</span></a>', text
    )
    links = {value: (unescape(address), mark) for address, mark, value, _ in found}
    assert links["script"][1]
    for address, _ in links.values():
        assert "q=rover" in address
    assert 'type="hidden" name="kind" value="script"' in text
    for address, _, _, number in found:
        assert client.get(unescape(address) + "&format=json").json()["total"] == int(number)


def test_a_list_is_also_a_query(client: TestClient) -> None:
    """The link leads to the query page with SPARQL for the rows and filters; without a query there is no link."""
    text = client.get("/nodes?package=rover_robot").text
    (query,) = re.findall(r'href="/query\?query=([^"]+)">Edit as a query', text)
    assert 'VALUES ?package { "rover_robot" }' in unquote_plus(query)
    assert "Edit as a query" not in client.get("/findings").text


@_EVERY
def test_every_link_leads_somewhere(client: TestClient, name: str) -> None:
    """Cells, headings, filters and pages link to existing pages."""
    text = client.get(f"/{name}?limit=2").text.partition("<main")[2].partition("</main>")[0]
    addresses = {unescape(one) for one in re.findall(r'href="(/[^"]*)"', text)}
    assert len(addresses) > len(LISTS)
    assert {one: code for one in addresses if (code := client.get(one).status_code) != 200} == {}


def test_pages_are_followed_by_links(client: TestClient) -> None:
    """Links to the next and previous page preserve filters and order."""
    first = client.get("/topics?limit=5&sort=-giving&ends=both+ends").text
    (after,) = re.findall(r'href="([^"]*)">Next', first)
    second = client.get(unescape(after)).text
    assert "from 6 to" in second
    assert re.findall(r'href="([^"]*)">Previous', second) == ["/topics?limit=5&amp;sort=-giving&amp;ends=both+ends"]


@_EVERY
def test_the_number_of_rows_has_a_plural(name: str) -> None:
    """A list names several of its things by a plural, such as kinds of hardware."""
    assert LISTS[name].called(1) == LISTS[name].one
    assert LISTS[name].called(2).split()[0].endswith("s") or LISTS[name].called(2).endswith("s")


def test_an_unknown_format_is_refused(client: TestClient) -> None:
    """A format that lists do not support, by name or by header, is 406."""
    assert client.get("/nodes?format=xml").status_code == 406
    assert client.get("/nodes", headers={"Accept": "image/png"}).status_code == 406


def test_the_start_page_leads_to_lists(client: TestClient) -> None:
    """Each count links to its list, a source to its packages."""
    text = client.get("/").text
    assert all(f'href="/{name}"' in text for name in ("nodes", "packages", "topics", "hardware", "findings"))
    (packages,) = set(re.findall(r'href="(/packages\?repository=[^"]*)"', text))
    assert client.get(unescape(packages), headers={"Accept": "application/json"}).json()["total"] == 5
