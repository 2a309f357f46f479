#!/usr/bin/python3
"""Makes the API pages of the public headers with Doxygen, in build/docs/html: docs.py [ROOT]

Every warning of Doxygen is an error, with one exception: members of a class may lack a comment where name and type
tell enough. A header that does not begin with an @file comment is not written for Doxygen yet; it is skipped and
named. The last line counts the headers.
"""
import pathlib
import re
import subprocess
import sys

# A warning names its file and line; what has no comment is named with its kind and its scope.
WARNING = re.compile(r"^(?P<file>/.*?):(?P<line>\d+): (?:warning|error): (?P<text>.*)$")
OPTIONAL = re.compile(r"^Member .* of (?:class|struct|namespace .*THREELINK_ISA) .*is not documented\.$|"
                      r"^Member .* of namespace \S*THREELINK_ISA is not documented\.$|"
                      r"^Member \w+\(.*\) \(macro definition\) of file \S+ is not documented\.$")


def headers_of(root):
    return sorted(root.glob("src/*/include/**/*.hpp"))


def for_doxygen(header):
    return header.read_text(encoding="utf-8").startswith("/// @file")


def findings(log, skipped):
    """The lines of Doxygen's log that count, and the files that they name."""
    lines, files = [], set()
    for line in log.splitlines():
        found = WARNING.match(line)
        if found and (found["file"] in skipped or OPTIONAL.match(found["text"])):
            continue
        if line.strip():
            lines.append(line)
            if found:
                files.add(found["file"])
    return lines, files


def main(root):
    headers = headers_of(root)
    skipped = {str(header) for header in headers if not for_doxygen(header)}
    output = root / "build" / "docs"
    output.mkdir(parents=True, exist_ok=True)
    log = output / "warnings.log"
    log.unlink(missing_ok=True)
    status = subprocess.run(["doxygen", "docs/Doxyfile"], cwd=root, stdin=subprocess.DEVNULL, check=False).returncode
    lines, files = findings(log.read_text(encoding="utf-8") if log.exists() else "", skipped)
    if status:
        lines.append(f"doxygen ended with status {status}")
    for line in lines:
        print(line)
    for header in sorted(skipped):
        print(f"skipped {pathlib.Path(header).relative_to(root)}: its comments are not written for Doxygen")
    failed = len(files) or (1 if lines else 0)
    passed = len(headers) - len(skipped) - failed
    if not failed:
        print(f"API pages: {output}/html/index.html")
    last = f"{passed} passed, {failed} failed"
    print(last + (f", {len(skipped)} skipped" if skipped else ""))
    return 0 if passed > 0 and not failed else 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()))
