#!/usr/bin/python3
"""Checks that no folder of src/ includes a header of a higher folder.

docs/method.md states the order in the line after "Order of the folders:".
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def folder_order():
    text = (ROOT / "docs" / "method.md").read_text()
    match = re.search(r"Order of the folders:\s*`([^`]+)`", text)
    if not match:
        sys.exit("docs/method.md does not state the order of the folders")
    return match.group(1).split()


def wrong_includes(order):
    rank = {folder: number for number, folder in enumerate(order)}
    for path in sorted((ROOT / "src").rglob("*.[hc]*")):
        folder = path.relative_to(ROOT / "src").parts[0]
        if folder not in rank:
            yield f"src/{folder} is missing in the order of docs/method.md"
            continue
        for name in re.findall(r'#include "([^"]+)"', path.read_text()):
            target = name.split("/")[0]
            if target != "cbmv_stereo" and rank.get(target, len(order)) > rank[folder]:
                yield f"{path.relative_to(ROOT)} includes {name}, of a higher folder or unknown"
    for path in sorted((ROOT / "include").rglob("*.h")):
        for name in re.findall(r'#include "([^"]+)"', path.read_text()):
            if not name.startswith("cbmv_stereo/"):
                yield f"{path.relative_to(ROOT)} is public and includes {name}, which is not"


def main():
    faults = list(wrong_includes(folder_order()))
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
