"""The codes of the server: KG52x are requests, KG54x how the server is started."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG520": CodeEntry(
        "bad request",
        "A parameter is missing, duplicated or malformed, or the body is malformed.",
        "Correct the part that the message names. `/openapi.json` describes every address.",
    ),
    "KG521": CodeEntry(
        "address not found",
        "The server has nothing at this address.",
        "Start at `/`, or see `/openapi.json`.",
    ),
    "KG522": CodeEntry(
        "method not allowed",
        "The address does not support this HTTP method.",
        "Use one of the methods in the header `Allow`.",
    ),
    "KG523": CodeEntry(
        "not acceptable",
        "The result cannot be written in a format that the header `Accept` or the parameter `format` allows.",
        "Request one of the formats that the message lists.",
    ),
    "KG524": CodeEntry(
        "unsupported media type",
        "The address does not support the media type or the encoding of the body.",
        "Send one of the types that the message lists, uncompressed.",
    ),
    "KG525": CodeEntry(
        "body too large",
        "The body exceeds the maximum number of bytes.",
        "Send less at once, or start the server with a larger `--max-body-bytes`.",
    ),
    "KG526": CodeEntry(
        "address too long",
        "The address exceeds the maximum length.",
        "Send a long query in the body of a POST.",
    ),
    "KG527": CodeEntry(
        "wrong host",
        "The header `Host` names a host that the server is not configured for.",
        "Use an address that `kg serve` printed, or start the server with `--allow-host NAME`.",
    ),
    "KG528": CodeEntry(
        "cross-site request",
        "A page of another site sent the request. Other sites must not read or change this store.",
        "Open the pages of this server, or start it with `--cors ORIGIN` to give that site read access.",
    ),
    "KG529": CodeEntry(
        "token required",
        "The request has no token or a wrong one.",
        "Send `Authorization: Bearer TOKEN`, or log in at `/login`.",
    ),
    "KG530": CodeEntry(
        "read-only",
        "The server was started read-only and refuses changes.",
        "Start it with `kg serve --write`. Send changes to the SPARQL server itself if `--store` names one.",
    ),
    "KG531": CodeEntry(
        "too many requests",
        "One client sent too many requests in a short time.",
        "Wait for the number of seconds in the header `Retry-After`.",
    ),
    "KG532": CodeEntry(
        "request too slow",
        "The headers or the body did not arrive in time.",
        "Send the request again on a faster connection.",
    ),
    "KG533": CodeEntry(
        "too many concurrent requests",
        "The server has reached its limit of concurrent requests. It still answers /health and /metrics.",
        "Try again in a moment.",
    ),
    "KG534": CodeEntry(
        "limit cannot be raised",
        "The request asks for more time or rows than clients without the token get.",
        "Ask for less, or send the token.",
    ),
    "KG535": CodeEntry(
        "headers too long",
        "The headers of the request are too many or too long.",
        "Send fewer cookies and headers.",
    ),
    "KG536": CodeEntry(
        "precondition failed",
        "`If-Match` names outdated data or a missing graph, or `If-None-Match` requires that an existing graph be "
        "missing.",
        "Read the current data, and send the change again with its `ETag`.",
    ),
    "KG540": CodeEntry(
        "open to the network",
        "The server is reachable from other machines, and anyone there could read the store.",
        "Set a token (`KG_TOKEN` or `--token-file FILE`). If everyone is allowed to read, add `--no-auth`.",
    ),
    "KG541": CodeEntry(
        "missing or invalid token",
        "The server needs a token, but has none or an invalid one.",
        "Write at least 16 characters into `KG_TOKEN`, or into the file of `--token-file`, readable only by you.",
    ),
    "KG542": CodeEntry(
        "address in use",
        "The server cannot listen at the address, which another program might be using.",
        "Stop the program that listens there, or choose another `--port`.",
    ),
}
