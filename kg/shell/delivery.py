"""Delivery of late results: a result reaches its widget only while that is open."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from textual.css.query import NoMatches
from textual.strip import Strip
from textual.widget import Widget

from kg.errors import KgError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from textual.geometry import Region
    from textual.message import Message
    from textual.message_pump import MessagePump

    from kg.shell.app import Shell

Answer = TypeVar("Answer")


def is_open(widget: Widget) -> bool:
    """Return whether a widget is composed, on a screen, and neither it nor the shell is closing."""
    return widget.is_mounted and not _is_closing(widget)


def _is_closing(widget: Widget) -> bool:
    """Return whether a widget is closing or closed: a screen first leaves the stack, then loses its parts."""
    return (
        not (widget.is_attached and widget.app.is_running and widget.screen in widget.app.screen_stack)
        or any(node._pruning for node in widget.ancestors_with_self)  # noqa: SLF001 - no public attribute has it
    )


def is_late(error: BaseException, place: object) -> bool:
    """Return whether an error means that a message or result found the parts of a closing widget gone."""
    return isinstance(error, NoMatches) and isinstance(place, Widget) and _is_closing(place)


def deliver(
    widget: Widget,
    request: Callable[[], Awaitable[Answer]],
    show: Callable[[Answer], object],
    fail: Callable[[KgError], object],
    latest: str = "",
) -> None:
    """Await a request in a worker of a widget; pass the result to `show`, an error to `fail`, if the widget is open.

    `show` and `fail` complete before anything can close the widget. A new request cancels earlier ones of the widget
    with the same name in `latest`.
    """

    async def worker() -> Any:
        try:
            answer = await request()
        except KgError as error:
            if is_open(widget):
                fail(error)
        else:
            if is_open(widget):
                show(answer)

    widget.run_worker(worker, group=latest or "default", exclusive=bool(latest))


def guard(pump: MessagePump, shell: Shell) -> None:
    """Let handlers of a widget fail without ending its message loop, which would end or freeze the shell."""
    dispatch = pump._dispatch_message  # noqa: SLF001 - the one place that all handlers are called from

    async def guarded(message: Message) -> None:
        try:
            await dispatch(message)
        except Exception as error:  # noqa: BLE001 - the last resort
            shell.fail(error, pump)

    pump._dispatch_message = guarded  # type: ignore[method-assign]  # noqa: SLF001 - as above
    if isinstance(pump, Widget):
        _blank_once_removed(pump)


def _blank_once_removed(widget: Widget) -> None:
    """Let a removed widget draw nothing: the screen may draw it again before the layout changes."""
    draw = widget.render_lines

    def drawn(crop: Region) -> list[Strip]:
        return draw(crop) if widget.is_attached else [Strip.blank(crop.width)] * crop.height

    widget.render_lines = drawn  # type: ignore[method-assign]  # of this one widget
