from __future__ import annotations

import json
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lint.robot import finding

from kg.lint.finding import Evidence
from kg.lint.objects import as_object, remark, spelled, suite_name, xunit
from kg.render.sarif import document

CODE: Final = Evidence("base/src/laser.cpp", 6, "local/rover", "publishes /scan_raw")


def test_the_fields_of_json() -> None:
    """The fields are those of docs/formats.md, with files relative to the repository."""
    record = as_object(finding(evidence=(CODE,), hint="so", also=("x/y.launch",)))
    assert record.pop("fingerprint") == finding().fingerprint
    assert record == {
        "code": "KG407",
        "rule": "architecture/remap-to-unused",
        "severity": "warning",
        "system": "bringup/launch/base.launch",
        "message": "nothing else uses /a",
        "subjects": ["/a"],
        "file": "bringup/launch/base.launch",
        "line": 3,
        "evidence": [
            {
                "file": "base/src/laser.cpp",
                "line": 6,
                "repository": "local/rover",
                "words": "publishes /scan_raw",
                "chain": None,
            }
        ],
        "repository": "local/rover",
        "chain": None,
        "presumes_whole": False,
        "also": ["x/y.launch"],
        "hint": "so",
        "replacement": None,
    }


@pytest.mark.parametrize(
    ("root", "folder", "path"),
    [
        ("/ws/rover", "/ws", "rover/base/src/laser.cpp"),
        ("/ws/rover", "/ws/rover", "base/src/laser.cpp"),
        ("/ws/rover", "/elsewhere", "base/src/laser.cpp"),
        ("", "/ws", "base/src/laser.cpp"),
    ],
)
def test_files_are_named_as_seen_from_a_folder(root: str, folder: str, path: str) -> None:
    """Files are relative to the working folder if below it, else to their source."""
    assert spelled(CODE, {"local/rover": root}, Path(folder)) == path


def test_sarif_has_the_evidence() -> None:
    """Evidence becomes related locations; the fingerprint identifies findings for code hosts."""
    content = document([remark(finding(evidence=(CODE,)), {}, Path("/"))])
    (run,) = json.loads(json.dumps(content))["runs"]
    (result,) = run["results"]
    assert result["level"] == "warning"
    assert result["partialFingerprints"] == {"kg/v1": finding().fingerprint}
    (related,) = result["relatedLocations"]
    assert related["physicalLocation"]["artifactLocation"]["uri"] == "base/src/laser.cpp"
    assert related["message"]["text"] == "publishes /scan_raw"


@pytest.mark.parametrize(
    ("file", "name"),
    [("test_results/base/kg_lint.xunit.xml", "base.kg_lint"), ("/r/p/lint.xml", "p.lint")],
)
def test_suites_are_named_as_ament_names_them(file: str, name: str) -> None:
    """Suites are named after the folder and the file."""
    assert suite_name(Path(file)) == name


def test_a_test_without_failures_has_one_case() -> None:
    """Notes pass; a result without cases would count as empty."""
    suite = ET.fromstring(xunit([finding(severity="note")], "p.lint", 1.5, ["a.launch:3"]))  # noqa: S314 - our own text
    assert dict(suite.attrib) == {"name": "p.lint", "tests": "1", "errors": "0", "failures": "0", "time": "1.500"}
    assert [case.get("name") for case in suite.iter("testcase")] == ["kg lint"]
    assert suite.findtext("system-out") == "a.launch:3: nothing else uses /a\n"


@settings(deadline=None)
@given(st.lists(st.text(), max_size=4))
def test_any_message_makes_valid_xml(messages: list[str]) -> None:
    """Each error or warning is a failing case, whatever its text."""
    found = [finding(message=message) for message in messages]
    text = xunit(found, "p.lint", 0, messages).encode("utf-8", "replace")
    suite = ET.fromstring(text)  # noqa: S314 - our own text
    assert len(list(suite.iter("failure"))) == len(messages)
    assert suite.get("tests") == str(max(1, len(messages)))
