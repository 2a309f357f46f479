#!/usr/bin/python3
"""Prepares a header for Doxygen: doxygen_filter.py HEADER

Equations and tables in `///` comments are lines that are indented by three spaces or more. Doxygen would join them
into a paragraph and read their symbols as markup; between @code{.unparsed} and @endcode it shows them as they are. In
the rest of a comment, what Doxygen would take for HTML or a command is escaped.
"""
import re
import sys


def escaped(match):
    return match[0] if match[0].startswith("`") else "\\" + match[0]


def filtered(lines):
    verbatim, margin = False, ""
    for line in lines:
        comment = re.match(r"(.*?)///(<?)(.*)$", line)
        indented = bool(comment) and not comment[1].strip() and not comment[2] and comment[3].startswith("   ")
        if indented and not verbatim:
            yield comment[1] + "/// @code{.unparsed}"
        elif verbatim and not indented:
            yield margin + "/// @endcode"
        verbatim = indented
        if indented:
            margin = comment[1]
        elif comment and not comment[3].startswith(" @"):
            line = f"{comment[1]}///{comment[2]}" + re.sub(r"`[^`]*`|[<>#@\\%]", escaped, comment[3])
        yield line


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        print("\n".join(filtered(file.read().split("\n"))), end="")
