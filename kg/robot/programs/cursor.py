"""Where the reader of a program stands among the tokens, and what it says when it cannot go on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.robot.programs.tokens import refusal, tokens
from kg.robot.programs.words import BEGINNINGS, ENDINGS
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from kg.errors import RobotError
    from kg.robot.programs.tokens import Kind, Token

__all__ = ["Cursor"]


class Cursor:
    """The tokens of a text, the comments that wait for a statement, and the places of the parts read so far.

    `begun` are the lines of the statements that are being read, the innermost last.
    """

    def __init__(self, text: str, path: str) -> None:
        """Read the tokens; RobotError KG830 at what can be none."""
        self.text = text.replace("\r\n", "\n").removeprefix("\ufeff")
        self.path = path
        self.comments: list[str] = []
        self.begun: list[int] = []
        self.places: dict[str, tuple[int, int]] = {}
        self._tokens = list(tokens(self.text, path))
        self._next = 0

    @property
    def token(self) -> Token:
        """The token that is read next."""
        return self._tokens[self._next]

    def ahead(self, far: int = 1) -> Token:
        """Return a token behind the next one; the last one from there on."""
        return self._tokens[min(self._next + far, len(self._tokens) - 1)]

    def take(self) -> Token:
        """Return the next token and step over it."""
        token = self.token
        self._next = min(self._next + 1, len(self._tokens) - 1)
        return token

    def kind(self, *kinds: Kind) -> bool:
        """Tell whether the next token is of one of these kinds."""
        return self.token.kind in kinds

    def word(self, *words: str) -> bool:
        """Tell whether the next token is one of these words, in capitals or not."""
        return self.token.kind == "word" and self.token.value.lower() in words

    def phrase(self, phrase: str) -> bool:
        """Step over the words of a phrase if they are next, and tell whether they were."""
        words = phrase.split()
        found = [self.ahead(far) for far in range(len(words))]
        if [one.value.lower() if one.kind == "word" else "" for one in found] != words:
            return False
        self._next += len(words)
        return True

    def sign(self, *signs: str) -> bool:
        """Tell whether the next token is one of these signs."""
        return self.token.kind == "sign" and self.token.value in signs

    def note(self, path: str) -> None:
        """Remember that what has this path in the tree begins here."""
        self.places.setdefault(path, (self.token.line, self.token.column))

    def skip(self) -> None:
        """Step over ends of lines, and keep the comments."""
        while self.kind("line", "comment"):
            token = self.take()
            if token.kind == "comment":
                self.comments.append(token.value)

    def told(self) -> str:
        """Return the comments that waited, as one."""
        comment = "\n".join(self.comments)
        self.comments.clear()
        return comment

    def expected(self, what: str, *, hint: str | None = None) -> RobotError:
        """Return the error (KG830) that something else should stand here, with the word that may have been meant."""
        begin = self._next
        while begin and self._tokens[begin - 1].kind != "line":
            begin -= 1
        first = self._tokens[begin]
        meant = None
        if first.kind == "word" and first.value.lower() not in BEGINNINGS | ENDINGS:
            meant = did_you_mean(first.value, BEGINNINGS | ENDINGS)
        return refusal(self.text, self.path, self.token, f"expected {what}, found {self.token}", meant or hint)

    def refused(self, token: Token, message: str, hint: str | None = None) -> RobotError:
        """Return the error (KG830) that the program cannot be read at a token."""
        return refusal(self.text, self.path, token, message, hint)
