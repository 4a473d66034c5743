#!/usr/bin/env python3
"""Writes the programs of a document as files: every ```cpp block with a main().

    doc_programs.py DOCUMENT FOLDER     prints the files' names, one a line
"""
import re
import sys
from pathlib import Path


def main(document, folder):
    blocks = re.findall(r"```cpp\n(.*?)```", Path(document).read_text(encoding="utf-8"), re.DOTALL)
    Path(folder).mkdir(parents=True, exist_ok=True)
    for number, block in enumerate((block for block in blocks if "int main()" in block), start=1):
        path = Path(folder) / f"doc_program_{number}.cpp"
        if not path.exists() or path.read_text(encoding="utf-8") != block:
            path.write_text(block, encoding="utf-8")
        print(path)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
