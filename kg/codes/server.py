"""The codes of the server: KG52x are requests, KG54x how the server is started."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG520": CodeEntry(
        "bad request",
        "The request is not what this address takes: a parameter is missing, doubled or malformed, or the body is.",
        "The message names what is wrong; `/openapi.json` describes every address.",
    ),
    "KG521": CodeEntry(
        "no such address",
        "The server has nothing at this address.",
        "Start at `/`, or see `/openapi.json`.",
    ),
    "KG522": CodeEntry(
        "method not allowed",
        "The address does not take this HTTP method.",
        "Use one of the methods in the header `Allow`.",
    ),
    "KG523": CodeEntry(
        "not acceptable",
        "The answer cannot be written in a format that the header `Accept` or the parameter `format` allows.",
        "Ask for one of the formats named.",
    ),
    "KG524": CodeEntry(
        "unsupported media type",
        "The body is of a type, or in an encoding, that the address does not take.",
        "Send one of the types named, not compressed.",
    ),
    "KG525": CodeEntry(
        "body too large",
        "The body has more bytes than a request may have.",
        "Send less at once, or start the server with a larger `--max-body-bytes`.",
    ),
    "KG526": CodeEntry(
        "address too long",
        "The address is longer than the server reads.",
        "Send a long query in the body of a POST.",
    ),
    "KG527": CodeEntry(
        "wrong host",
        "The header `Host` names another host than those that the server answers for.",
        "Use an address that `kg serve` printed, or start it with `--allow-host NAME`.",
    ),
    "KG528": CodeEntry(
        "request of another site",
        "A page of another site sent the request, which must not read or change this store.",
        "Open the pages of this server, or start it with `--cors ORIGIN` to let that site read.",
    ),
    "KG529": CodeEntry(
        "token needed",
        "The request needs the token of the server and has none, or a wrong one.",
        "Send `Authorization: Bearer TOKEN`, or log in at `/login`.",
    ),
    "KG530": CodeEntry(
        "read-only",
        "The server was started for reading; it changes nothing.",
        "Start it with `kg serve --write`.",
    ),
    "KG531": CodeEntry(
        "too many requests",
        "One client sent more requests than it may at a time.",
        "Wait for the seconds in the header `Retry-After`.",
    ),
    "KG532": CodeEntry(
        "request too slow",
        "The headers or the body did not arrive in time.",
        "Send the request again on a faster connection.",
    ),
    "KG533": CodeEntry(
        "too many requests at a time",
        "The server is answering as many requests as it may. It still answers /health and /metrics.",
        "Try again in a moment.",
    ),
    "KG534": CodeEntry(
        "limit may not be raised",
        "The request asks for more time or rows than the server gives to anyone without its token.",
        "Ask for less, or send the token.",
    ),
    "KG535": CodeEntry(
        "headers too long",
        "The request has more headers, or longer ones, than the server reads.",
        "Send fewer cookies and headers.",
    ),
    "KG536": CodeEntry(
        "precondition failed",
        "The header `If-Match` names data that is no longer in force, or wants a graph that is not there; or "
        "`If-None-Match` wants a graph not to be there that is.",
        "Read what holds now, and send the change again with its `ETag`.",
    ),
    "KG540": CodeEntry(
        "open to the network",
        "The server would be reached by other machines, and anyone there could read the store.",
        "Give it a token (`KG_TOKEN` or `--token-file FILE`), or say `--no-auth` when everyone may read.",
    ),
    "KG541": CodeEntry(
        "token",
        "The server needs a token that it does not have, or the one it was given cannot be used.",
        "Put at least 16 characters into `KG_TOKEN` or the file of `--token-file`, readable by you alone.",
    ),
    "KG542": CodeEntry(
        "address in use",
        "The server cannot listen at the address.",
        "Stop what listens there, or choose another `--port`.",
    ),
}
