#!/usr/bin/python3
"""Checks that a shared library exports exactly the symbols marked with CBMV_API in the public headers.

Usage: symbols_test.py LIBRARY
"""
import pathlib
import re
import subprocess
import sys

HEADERS = pathlib.Path(__file__).resolve().parents[2] / "include" / "cbmv_stereo"
CLASS = re.compile(r"\b(?:class|struct) CBMV_API (\w+)")
FUNCTION = re.compile(r"\bCBMV_API [^;{(]*?(\w+)\(")


def declared():
    text = "\n".join(path.read_text() for path in HEADERS.glob("*.h") if path.name != "export.h")
    return set(CLASS.findall(text)), set(FUNCTION.findall(text))


def exported(library):
    lines = subprocess.run(["nm", "-DC", "--defined-only", library], check=True, capture_output=True,
                           text=True).stdout.splitlines()
    return [line.split(maxsplit=2)[2] for line in lines]


def name_of(symbol):
    """The class or function of namespace cbmv that a demangled symbol belongs to, or None."""
    match = re.match(r"(?:vtable for |typeinfo for |typeinfo name for )?cbmv::(\w+)", symbol)
    return match.group(1) if match else None


def main():
    classes, functions = declared()
    symbols = exported(sys.argv[1])
    names = {symbol: name_of(symbol) for symbol in symbols}
    faults = [f"is exported, though no public header declares it: {symbol}" for symbol, name in names.items()
              if name not in classes | functions]
    faults += [f"is declared in a public header, but not exported: {name}" for name in functions
               if name not in names.values()]
    print("\n".join(faults))
    sys.exit(1 if faults or not symbols else 0)


if __name__ == "__main__":
    main()
