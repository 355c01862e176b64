"""Text of Open Rails and MSTS: words and nested blocks in round brackets, in UTF-8 or UTF-16.

Rules as the manual of Open Rails and its reader state them: `name ( words and blocks )`. A text in quotes may be
continued with `+`. `comment ( )` and `skip ( )` are ignored. A word that begins with # or _ is ignored, together with
the word or block behind it. `include ( file )` puts the content of a file in its place.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

from readers.formats.any_case import in_any_case
from readers.text import FileError, lines_of, quoted, text_of

#: Largest file [bytes], deepest nesting, deepest chain of included files, most included files of a vehicle.
LARGEST = 8_000_000
DEEPEST = 64
DEEPEST_INCLUDE = 16
MOST_INCLUDES = 200
#: A text in quotes with its continuations, a bracket, a bare word, or a quote without an end.
_QUOTED = r'"(?:[^"\\]|\\.)*"'
WORD = re.compile(
    rf'\s*(?:(?P<text>{_QUOTED}(?:\s*\+\s*{_QUOTED})*)|(?P<mark>[()])|(?P<bare>[^\s()"]+)|(?P<open>"))', re.DOTALL
)
PIECE = re.compile(_QUOTED, re.DOTALL)
#: First word of a file.
SIGNATURE = re.compile(r"\s*SIMIS\S*", re.IGNORECASE)
#: Blocks that may lack their closing bracket at the end of a file, one of them.
OUTER = ("train", "traincfg", "wagon", "engine")


class Word(str):
    """A word with its row, and whether it was in quotes."""

    row: int
    in_quotes: bool


@dataclass
class Block:
    """A block: its name in small letters, file and row of its name, and its words and blocks in their order."""

    name: str
    source: str = ""
    row: int = 0
    words: list[str] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)

    def last(self, name: str) -> Block | None:
        """Return the last block of a name, which is the valid one, or None."""
        return next((block for block in reversed(self.blocks) if block.name == name), None)

    def all(self, *names: str) -> list[Block]:
        """Return the blocks of these names in their order."""
        return [block for block in self.blocks if block.name in names]


class _Words:
    """Words of a text, one after the other."""

    def __init__(self, text: str, source: str) -> None:
        head = SIGNATURE.match(text)
        self.text, self.source = text, source
        self.place = head.end() if head else 0
        self.row = 1 + text.count("\n", 0, self.place)
        self.ahead: Word | None = None

    def next(self) -> Word | None:
        """Return the next word, or None at the end. Raises FileError for a text in quotes without an end."""
        if self.ahead is not None:
            word, self.ahead = self.ahead, None
            return word
        found = WORD.match(self.text, self.place)
        if found is None:
            return None
        kind = str(found.lastgroup)
        self.row += self.text.count("\n", self.place, found.start(kind))
        if kind == "open":
            raise FileError(f"{self.source}, row {self.row}: a text in quotes must end; got no second quote. Add it.")
        word = Word(_unquoted(found[kind]) if kind == "text" else found[kind])
        word.row, word.in_quotes = self.row, kind == "text"
        self.row += found[kind].count("\n")
        self.place = found.end()
        return word

    def peek(self) -> Word | None:
        """Return the next word and leave it there."""
        self.ahead = self.next()
        return self.ahead

    def skip_block(self, row: int) -> None:
        """Go behind the block that begins here. Raises FileError if it does not end."""
        depth = 0
        while (word := self.next()) is not None:
            depth += (word == "(" and not word.in_quotes) - (word == ")" and not word.in_quotes)
            if depth == 0:
                return
        raise FileError(f"{self.source}, row {row}: the bracket of a comment must be closed; got the end of the file.")


def _unquoted(text: str) -> str:
    return "".join(re.sub(r"\\([\"\\])", r"\1", piece[1:-1]) for piece in PIECE.findall(text))


class Reader:
    """Reads a file and those that it includes.

    Attributes
    ----------
    remarks : list of str
        Sentences about faults that do not change the meaning of a field.
    """

    def __init__(self) -> None:
        self.remarks: list[str] = []
        self._included = 0

    def read(self, path: Path) -> Block:
        """Return a block without a name that has the content of a file."""
        root = Block("")
        self._add(path, root, ())
        return root

    def _add(self, path: Path, root: Block, behind: tuple[Path, ...]) -> None:
        """Add the content of a file to a block; `behind`: the files that include it."""
        words = _Words("\n".join(lines_of(text_of(path, LARGEST, unmarked=True))), str(path))
        stack, name = [root], None
        while (word := words.next()) is not None:
            bare, named, name = not word.in_quotes, name, None
            if bare and word == "(":
                self._open(stack, named, word, words)
            elif bare and word == ")":
                self._close(stack, word, words)
            elif bare and word[0] in "#_":
                self._skip(words, word)
            elif bare and word.lower() in ("comment", "skip") and words.peek() == "(":
                words.skip_block(word.row)
            elif bare and word.lower() == "include" and words.peek() == "(":
                self._include(words, stack[-1], (*behind, path))
            else:
                stack[-1].words.append(word)
                name = word
        self._end(stack, words)

    def _open(self, stack: list[Block], named: Word | None, word: Word, words: _Words) -> None:
        """Begin a block, whose name is the word before it."""
        if len(stack) > DEEPEST:
            raise FileError(
                f"{words.source}, row {word.row}: brackets must nest at most {DEEPEST} deep; got more. Close them."
            )
        if named is not None:
            stack[-1].words.pop()
        block = Block("" if named is None else named.lower(), words.source, word.row)
        stack[-1].blocks.append(block)
        stack.append(block)

    def _close(self, stack: list[Block], word: Word, words: _Words) -> None:
        """End a block; a bracket too many is remarked."""
        if len(stack) > 1:
            stack.pop()
        else:
            self.remarks.append(f"{Path(words.source).name}, row {word.row}: a closing bracket too many is ignored.")

    def _skip(self, words: _Words, word: Word) -> None:
        """Ignore the word or block behind a word that begins with # or _."""
        behind = words.peek()
        if behind is None or (behind == ")" and not behind.in_quotes):
            return
        if behind == "(" and not behind.in_quotes:
            words.skip_block(word.row)
            return
        hidden = words.next()
        if hidden is not None and hidden.row > word.row and words.peek() == "(":
            self.remarks.append(
                f"{Path(words.source).name}, row {word.row}: {quoted(word)} hides {hidden} in row {hidden.row}, as in "
                "Open Rails. Write comment ( ) around remarks."
            )

    def _include(self, words: _Words, block: Block, behind: tuple[Path, ...]) -> None:
        """Add the content of an included file to a block."""
        words.next()
        given, end = words.next(), words.next()
        if given is None or given in ("(", ")") or end != ")":
            raise FileError(
                f"{words.source}, row {words.row}: include must name one file; got none or more. Correct it."
            )
        path = in_any_case(behind[-1].parent, str(given))
        place = f"{words.source}, row {given.row}"
        if path is None:
            raise FileError(f"{place}: the included file {quoted(given)} does not exist. Check the path.")
        self._included += 1
        if path.resolve() in [one.resolve() for one in behind]:
            raise FileError(
                f"{place}: a file must not include itself; got {quoted(given)} inside itself. Take it away."
            )
        if len(behind) > DEEPEST_INCLUDE or self._included > MOST_INCLUDES:
            raise FileError(
                f"{place}: included files must be at most {DEEPEST_INCLUDE} deep and {MOST_INCLUDES} in number; got "
                "more. Take some away."
            )
        self._add(path, block, behind)

    def _end(self, stack: list[Block], words: _Words) -> None:
        """Check that all blocks are closed at the end of a file, but for one outer block."""
        missing = stack[1:]
        if not missing:
            return
        if len(missing) == 1 and missing[0].name in OUTER:
            self.remarks.append(
                f"{Path(words.source).name}: the closing bracket of {missing[0].name} in row {missing[0].row} is "
                "missing at the end; check that the file is whole."
            )
            return
        raise FileError(
            f"{words.source} must close the bracket of {quoted(missing[-1].name)} in row {missing[-1].row}; got the "
            "end of the file. Check that the file is whole."
        )
