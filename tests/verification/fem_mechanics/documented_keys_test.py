#!/usr/bin/python3
"""Every key that fem_stage reads from a case file is in docs/fem.md.

documented_keys_test.py REPOSITORY
"""
import pathlib
import re
import sys

SOURCES = ["model/fem_case.cpp", "model/boundary_options.cpp", "material/material_definition.cpp",
           "element_test/element_test_case.cpp", "element_test/calibration.cpp"]
READERS = ("number|number_or|number_if|integer|integer_or|boolean_or|text|text_or|texts_or|choice|choice_or|numbers|numbers_or|"
           "table|file|object|object_if|object_or_empty|list|list_or_empty")


def main():
    root = pathlib.Path(sys.argv[1])
    page = (root / "docs/fem.md").read_text()
    missing, known = [], 0
    for name in SOURCES:
        text = (root / "fem_stage" / name).read_text()
        keys = set(re.findall(rf'[.>](?:{READERS})\(\s*"(\w+)"', text))
        keys |= set(re.findall(r'(?:optional_number|read_points)\(node, "(\w+)"', text))
        known += len(keys)
        missing += [f"{name}: {key}" for key in sorted(keys) if not re.search(rf"\b{key}\b", page)]
    print("\n".join(missing) or f"{known} keys, all in docs/fem.md")
    sys.exit(1 if missing or known < 100 else 0)


if __name__ == "__main__":
    main()
