#!/usr/bin/python3
"""Every key that fem_stage and mpm_stage read from a case file, and every soil model of fem_stage, is in docs/fem.md or
docs/mpm.md; what transfer_tool reads is in docs/transfer.md.

documented_keys_test.py REPOSITORY
"""
import pathlib
import re
import sys

PAGES = {
    "docs/fem.md": ["fem_stage/model/fem_case.cpp", "fem_stage/model/boundary_options.cpp",
                    "fem_stage/model/liquefied_strength.cpp",
                    "fem_stage/material/*.?pp", "fem_stage/element_test/element_test_case.cpp",
                    "fem_stage/element_test/calibration.cpp"],
    "docs/mpm.md": ["mpm_stage/scene/*.cpp", "mpm_stage/material/*.cpp", "common/residual_strength/*.cpp"],
    "docs/transfer.md": ["transfer_tool/options/transfer_case.cpp", "common/residual_strength/*.cpp"],
}
READERS = ("number|number_or|number_if|integer|integer_or|boolean_or|text|text_or|texts_or|choice|choice_or|numbers|numbers_or|"
           "table|file|object|object_if|object_or_empty|list|list_or_empty")


def main():
    root = pathlib.Path(sys.argv[1])
    missing, known = [], 0
    for page, sources in PAGES.items():
        content = (root / page).read_text()
        for source in sorted(path for pattern in sources for path in root.glob(pattern)):
            name, text = source.relative_to(root), source.read_text()
            keys = set(re.findall(rf'[.>](?:{READERS})\(\s*"(\w+)"', text))
            keys |= set(re.findall(r'(?:read_number|read_optional|read_points)\(node, "(\w+)"', text))
            keys |= set(re.findall(r'model_name = "(\w+)"', text))
            known += len(keys)
            missing += [f"{name}: {key} is not in {page}" for key in sorted(keys) if not re.search(rf"\b{key}\b", content)]
    print("\n".join(missing) or f"{known} keys, all documented")
    sys.exit(1 if missing or known < 200 else 0)


if __name__ == "__main__":
    main()
