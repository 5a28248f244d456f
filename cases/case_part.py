#!/usr/bin/env python3
"""Writes part of a case file, so that a stage depends on what it reads and no more.

    case_part.py fem.json --keep mesh -o FILE          only these keys
    case_part.py fem.json --drop shake output -o FILE  all but these

FILE is left alone, date and all, when its content would stay the same.
"""

import argparse
import json
import re
import sys
from pathlib import Path


def without_comments(text):
    """JSON text without // and /* */ comments, which case files may contain; strings are left alone."""
    pattern = r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/'
    return re.sub(pattern, lambda found: found.group(1) or " ", text, flags=re.DOTALL)


def read_case(path):
    return json.loads(without_comments(Path(path).read_text()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=Path)
    parser.add_argument("--keep", nargs="+")
    parser.add_argument("--drop", nargs="+", default=[])
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    try:
        case = read_case(arguments.case)
    except (OSError, ValueError) as error:
        print(f"{arguments.case}: {error}", file=sys.stderr)
        return 1
    part = {key: case[key] for key in case if key not in arguments.drop and key in (arguments.keep or case)}
    text = json.dumps(part, indent=1, sort_keys=True) + "\n"
    if not arguments.output.exists() or arguments.output.read_text() != text:
        arguments.output.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
