"""Request parameters, from the address and from a form, and the media type of the body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from urllib.parse import parse_qsl

from kg.server.errors import RequestError

if TYPE_CHECKING:
    from starlette.requests import Request

FORM: Final = "application/x-www-form-urlencoded"
"""The media type of forms."""

_MOST: Final = 10_000


class Parameters:
    """The parameters of a request, in its order; those of the address come before those of a form."""

    def __init__(self, address: bytes, form: bytes = b"") -> None:
        """Raise RequestError KG520 for parameters that are not in UTF-8."""
        self._values: dict[str, list[str]] = {}
        for part in (address, form):
            if part:
                self._read(part)

    def _read(self, part: bytes) -> None:
        try:
            pairs = parse_qsl(part.decode(), keep_blank_values=True, errors="strict", max_num_fields=_MOST)
        except UnicodeDecodeError as error:
            raise RequestError("KG520", "the parameters are not in UTF-8") from error
        except ValueError as error:
            raise RequestError("KG520", f"the request has more than {_MOST} parameters") from error
        for name, value in pairs:
            self._values.setdefault(name, []).append(value)

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def pairs(self) -> list[tuple[str, str]]:
        """Names and values of all parameters."""
        return [(name, value) for name, values in self._values.items() for value in values]

    def all(self, name: str) -> tuple[str, ...]:
        """Return all values of a parameter."""
        return tuple(self._values.get(name, ()))

    def one(self, name: str) -> str | None:
        """Return the value of a parameter; RequestError KG520 if it is repeated."""
        values = self._values.get(name)
        if values and len(values) > 1:
            raise RequestError("KG520", f"the parameter `{name}` is given {len(values)} times; give it once")
        return values[0] if values else None

    @property
    def formats(self) -> tuple[str, ...]:
        """The requested formats; they might be unknown or empty."""
        return tuple(filter(None, self.all("format") + self.all("output")))

    def starting(self, prefix: str) -> dict[str, str]:
        """Return the parameters whose names start with `prefix`, without the prefix."""
        return {name.removeprefix(prefix): self.one(name) or "" for name in self._values if name.startswith(prefix)}

    def number(self, name: str, *, least: float = 0) -> float | None:
        """Return the value of a parameter as a number of at least `least`; RequestError KG520 for others."""
        text = self.one(name)
        if text is None:
            return None
        try:
            number = float(text)
        except ValueError:
            number = float("nan")
        if not least <= number < float("inf"):
            raise RequestError("KG520", f"`{name}={text}` is not a number of at least {least:g}")
        return number

    def whole(self, name: str, *, most: int = 1 << 62) -> int | None:
        """Return the value of a parameter as an integer from 0 to `most`; RequestError KG520 for others."""
        text = self.one(name)
        if text is None:
            return None
        if not (text.isascii() and text.isdigit() and len(text) < len(str(most)) + 1 and int(text) <= most):
            raise RequestError("KG520", f"`{name}={text}` is not a whole number from 0 to {most}")
        return int(text)

    def flag(self, name: str) -> bool:
        """Return whether a parameter is set: `true`, `1`, or without a value; RequestError KG520 for other values."""
        text = (self.one(name) or "true").lower() if name in self._values else "false"
        if text not in {"true", "false", "1", "0"}:
            raise RequestError("KG520", f"`{name}={text}` is neither true nor false")
        return text in {"true", "1"}


def media_type(request: Request) -> str:
    """Return the media type of the body in lower case, without parameters; empty if it is not given."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


def unsupported(kind: str, *supported: str) -> RequestError:
    """Return KG524 for a body of the media type `kind`, empty if it is not given."""
    message = f"unsupported content type `{kind}`" if kind else "the Content-Type header is missing"
    return RequestError("KG524", message, hint=f"Send {' or '.join(supported)}.")


def in_utf8(request: Request) -> None:
    """Raise RequestError KG524 for a body declared in another encoding than UTF-8."""
    for parameter in request.headers.get("content-type", "").lower().split(";")[1:]:
        name, _, value = parameter.partition("=")
        if name.strip() == "charset" and value.strip(' "') not in {"utf-8", "utf8", "us-ascii"}:
            raise RequestError("KG524", f"unsupported charset `{value.strip()}`", hint="Send the body in UTF-8.")


def body_text(request: Request, body: bytes) -> str:
    """Return a body as text; RequestError KG524 for another declared encoding than UTF-8, KG520 for invalid UTF-8."""
    in_utf8(request)
    return decoded(body)


def decoded(body: bytes) -> str:
    """Return a body as text; RequestError KG520 for invalid UTF-8."""
    try:
        return body.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise RequestError("KG520", f"the body is not in UTF-8 at byte {error.start}") from error
