from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.errors import UsageError
from kg.lint.question import DECLARED as LINT
from kg.server.options import DECLARED as SERVE
from kg.settings import DECLARED, Settings, find_file, load, load_table, table

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.settings import Declaration


def write(folder: Path, text: str) -> Path:
    """Write kg.toml into a folder."""
    path = folder / "kg.toml"
    path.write_text(text)
    return path


def refusal(folder: Path, environment: dict[str, str] | None = None, **flags: object) -> UsageError:
    """Return the error raised by loading."""
    with pytest.raises(UsageError) as caught:
        load(flags, environment=environment or {}, folder=folder)
    return caught.value


def test_defaults_have_the_origin_default(tmp_path: Path) -> None:
    """An unset setting has the declared default and the origin `default`."""
    for declaration, value, origin in load(environment={}, folder=tmp_path).values():
        assert value == declaration.default
        assert str(origin) == "default"


def test_a_flag_wins_over_the_environment_and_that_over_the_file(tmp_path: Path) -> None:
    """The three places are searched in the documented order, and the origin names the winner."""
    path = write(tmp_path, "# mine\njobs = 1\nlimit = 1\ntimeout = 1\n")
    settings = load({"jobs": "3"}, environment={"KG_JOBS": "2", "KG_LIMIT": "2"}, folder=tmp_path)
    assert (settings.jobs, settings.limit, settings.timeout) == (3, 2, 1.0)
    origins = [str(settings.origin(name)) for name in ("jobs", "limit", "timeout")]
    assert origins == ["--jobs", "KG_LIMIT", f"{path}:4"]


def test_the_file_is_found_upwards(tmp_path: Path) -> None:
    """The nearest kg.toml above the working folder is used, and its paths are relative to it."""
    write(tmp_path, 'store = "data"\nqueries = ["mine"]\n')
    deep = tmp_path / "a" / "b"
    deep.mkdir(parents=True)
    settings = load(environment={}, folder=deep)
    assert settings.store == tmp_path / "data"
    assert settings.queries == (tmp_path / "mine",)
    assert find_file(deep) == tmp_path / "kg.toml"


def test_relative_paths_of_flags_start_at_the_working_folder(tmp_path: Path) -> None:
    """A path of a flag is relative to the working folder."""
    assert load({"store": "x"}, environment={}, folder=tmp_path).store == tmp_path / "x"


def test_an_unknown_key_names_its_line_and_the_nearest_setting(tmp_path: Path) -> None:
    """A misspelt key in kg.toml is reported with its line."""
    path = write(tmp_path, "jobs = 2\n\nmax_file_byte = 3\n")
    error = refusal(tmp_path)
    assert error.code == "KG002"
    assert str(error.place) == f"{path}:3"
    assert error.hint == "Did you mean `max_file_bytes`?"


def test_an_unknown_key_like_no_other_lists_the_settings(tmp_path: Path) -> None:
    """If no name is similar, all names are listed."""
    write(tmp_path, "zzz = 2\n")
    assert all(name in (refusal(tmp_path).hint or "") for name in DECLARED)


def test_a_file_that_is_no_toml_names_line_and_column(tmp_path: Path) -> None:
    """A syntax error has the place reported by the parser."""
    path = write(tmp_path, "jobs = 2\nlimit = = 3\n")
    assert str(refusal(tmp_path).place).startswith(f"{path}:2:")


def test_a_file_that_is_not_text_is_an_error_not_a_crash(tmp_path: Path) -> None:
    """A binary file named kg.toml is an error with its name."""
    (tmp_path / "kg.toml").write_bytes(b"\xff\xfe\x00")
    assert "kg.toml" in str(refusal(tmp_path).place)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("jobs", "many"),
        ("jobs", "-1"),
        ("jobs", "1.5"),
        ("timeout", "inf"),
        ("timeout", "nan"),
        ("limit", ""),
        ("max_file_bytes", "0"),
        ("max_file_bytes", "M"),
        ("base", "ftp://x/"),
        ("base", "https://"),
        ("base", "https://x/#"),
        ("color", "blue"),
        ("store", " "),
    ],
)
def test_bad_values_name_the_flag_and_the_value(tmp_path: Path, name: str, value: str) -> None:
    """An invalid value is shown with its flag."""
    flags: dict[str, Any] = {name: value}
    error = refusal(tmp_path, **flags)
    assert error.code == "KG002"
    assert DECLARED[name].flag in error.message
    assert repr(value) in error.message


def test_a_bad_variable_is_named(tmp_path: Path) -> None:
    """An invalid value of the environment is shown with its variable."""
    assert "KG_JOBS is 'x'" in refusal(tmp_path, {"KG_JOBS": "x"}).message


@pytest.mark.parametrize(("text", "size"), [("1000", 1000), ("2K", 2048), ("1.5m", 3 << 19), ("1G", 1 << 30)])
def test_sizes_have_units(tmp_path: Path, text: str, size: int) -> None:
    """K, M and G are powers of 1024, in either case."""
    assert load({"max_file_bytes": text}, environment={}, folder=tmp_path).max_file_bytes == size


def test_a_base_gets_its_slash(tmp_path: Path) -> None:
    """The base ends in a slash, because names are appended to it."""
    assert load({"base": "https://example.org/kg"}, environment={}, folder=tmp_path).base == "https://example.org/kg/"


def test_every_setting_is_told_in_a_sentence() -> None:
    """Help and documentation print the description, so it is a complete sentence."""
    for declaration in DECLARED.values():
        assert declaration.sentence.endswith(".")
        assert declaration.variable == declaration.flag.upper().replace("--", "KG_").replace("-", "_")


@given(st.dictionaries(st.sampled_from(sorted(DECLARED)), st.text() | st.integers() | st.floats() | st.booleans()))
def test_any_value_is_read_or_refused_with_a_code(flags: dict[str, Any]) -> None:
    """Any value of a flag gives settings or KG002."""
    codes = set()
    try:
        assert isinstance(load(flags, environment={}), Settings)
    except UsageError as error:
        codes.add(error.code)
    assert codes <= {"KG002"}


def test_tables_are_read_by_their_commands(tmp_path: Path) -> None:
    """A table of kg.toml does not affect the common settings, and its paths are relative to the file."""
    write(tmp_path, 'jobs = 2\n[lint]\nbaseline = "x"\ncode = ["kg401"]\n[[lint.allow]]\ncode = "KG407"\n')
    assert load(folder=tmp_path, environment={}).jobs == 2
    found = load_table(LINT, {"level": "error"}, environment={}, folder=tmp_path)
    assert found == {"baseline": tmp_path / "x", "codes": ("KG401",), "level": "error"}


def test_paths_of_flags_of_a_table_start_at_the_working_folder(tmp_path: Path) -> None:
    """`kg lint FOLDER --baseline FILE` finds the file relative to the working folder and reports it as typed."""
    assert load_table(LINT, {"baseline": "x"}, environment={}, folder=tmp_path) == {"baseline": Path("x")}


def test_variables_of_tables_name_the_table(tmp_path: Path) -> None:
    """KG_LINT_LEVEL is the level of `kg lint`; a switch accepts yes and no."""
    environment = {"KG_LINT_LEVEL": "warning", "KG_LINT_ALL": "yes"}
    assert load_table(LINT, {}, environment=environment, folder=tmp_path) == {"level": "warning", "every": True}
    with pytest.raises(UsageError, match="KG_LINT_ALL is 'often', which is not true or false"):
        load_table(LINT, {}, environment={"KG_LINT_ALL": "often"}, folder=tmp_path)


def test_an_unknown_key_of_a_table_names_its_line(tmp_path: Path) -> None:
    """The line is that in the table, even if another table has the same key."""
    path = write(tmp_path, "jobs = 2\n[serve]\nlevl = 1\n[lint]\nlevl = 1\n")
    with pytest.raises(UsageError, match="unknown setting `levl`") as caught:
        load_table(LINT, {}, environment={}, folder=tmp_path)
    assert str(caught.value.place) == f"{path}:5"
    assert caught.value.hint == "Did you mean `level`?"


@pytest.mark.parametrize("table_of", [LINT, SERVE], ids=["lint", "serve"])
@given(data=st.data())
def test_any_value_of_a_table_is_read_or_refused_with_a_code(
    data: st.DataObject, table_of: Mapping[str, Declaration]
) -> None:
    """Any value of a flag gives values or KG002."""
    values = st.text() | st.integers() | st.floats() | st.booleans() | st.lists(st.text())
    flags = data.draw(st.dictionaries(st.sampled_from(sorted(table_of)), values))
    codes = set()
    try:
        load_table(table_of, flags, environment={})
    except UsageError as error:
        codes.add(error.code)
    assert codes <= {"KG002"}


def test_defaults_are_what_their_texts_say() -> None:
    """The default shown by `--help` is the effective value."""
    for one in (*DECLARED.values(), *LINT.values(), *SERVE.values()):
        assert not one.shown or one.read(one.shown, Path()) == one.default


def test_a_table_has_to_be_one(tmp_path: Path) -> None:
    """A plain value with the name of a table is rejected with its line; a missing kg.toml or table gives none."""
    assert table("lint", tmp_path) is None
    write(tmp_path, "jobs = 2\n")
    other = tmp_path / "other"
    other.mkdir()
    assert table("lint", tmp_path) is None
    write(other, "\nlint = 3\n")
    with pytest.raises(UsageError, match="KG002: `lint` is a table, not 3") as caught:
        table("lint", other)
    assert caught.value.place is not None
    assert caught.value.place.line == 2


def test_what_was_chosen_goes_to_other_processes(tmp_path: Path) -> None:
    """Flags, variables and the file give another process the same values, whatever its working folder."""
    write(tmp_path, 'rules = ["mine"]\nlimit = 7\nmax_file_bytes = "500K"\n')
    chosen = load({"timeout": "2.5", "store": "here"}, environment={"KG_BASE": "https://example.org/"}, folder=tmp_path)
    other = tmp_path / "other"
    other.mkdir()
    again = load(json.loads(json.dumps(chosen.chosen())), environment={}, folder=other)
    assert "store" not in chosen.chosen()
    assert [value for one, value, _ in again.values() if one.name != "store"] == [
        value for one, value, _ in chosen.values() if one.name != "store"
    ]
