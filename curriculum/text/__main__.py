"""The gate: what chapter and README say, against what the code is and does.

    python -m curriculum.text                   # check, write nothing; exit 1 and a line a problem
    python -m curriculum.text --accept SECTION  # these sections have been read as they are now
    python -m curriculum.text --write           # make the README's generated blocks anew
    python -m curriculum.text --list            # every number that a text can quote, by name

It holds together: regions are well formed, and each is included once by the chapter; a section of
chapter or README was read again after its text, or the code of a region that it includes or names,
changed; numbers are quoted by reference, and `holds:` comments are true; measured results, rows of
the ledger and generated blocks are of today's code.
"""

import argparse
import json
import sys


def main(argv=None) -> int:
    """Check, accept, write or list. Returns the exit status: 0 in order, 1 not, 2 bad usage."""
    parser = argparse.ArgumentParser(
        prog="python -m curriculum.text",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--accept", metavar="SECTION", nargs="*", help="these have been read")
    parser.add_argument("--write", action="store_true", help="make the README's blocks anew")
    parser.add_argument("--list", action="store_true", help="list the numbers")
    args = parser.parse_args(argv)
    try:
        if args.list:
            return list_numbers()
        if args.write:
            return write()
        return check() if args.accept is None else accept(args.accept)
    except ModuleNotFoundError as error:
        package = error.name.split(".")[0]
        if package in ("contact", "curriculum"):
            raise
        return refuse(f"the gate needs {package}, which is missing: pip install -e '.[dev]'")
    except SyntaxError as error:
        return refuse(f"{error.filename}:{error.lineno}: not Python: {error.msg}")
    except (OSError, ValueError) as error:
        return refuse(error)


def refuse(error) -> int:
    """Say on stderr why nothing could be done. Returns the exit status."""
    print(error, file=sys.stderr)
    return 2


def check() -> int:
    """Print every problem, then what changed in the sections that wait for a reader."""
    from curriculum.text.gate import GATE, Gate
    from curriculum.text.sections import changes

    gate = Gate()
    problems = gate.check()
    recorded = gate.meta.get("section_hashes") or {}
    unread = [section for section in gate.unread if section.name in recorded]
    print(changes(unread, recorded), end="")
    print(*problems or ["text, code, numbers and results agree"], sep="\n")
    if len(gate.unread) > 1:
        names = " ".join(section.name for section in gate.unread)
        print(f"\nwhen all of them are read: {GATE} --accept {names}")
    return 1 if problems else 0


def accept(names) -> int:
    """Show what changed in these sections, and record that they were read as they are now."""
    from contact import write_whole
    from curriculum.text.gate import Gate, record
    from curriculum.text.regions import ROOT
    from curriculum.text.sections import changes, sections

    gate, found = Gate(), sections()
    unknown = [name for name in names if name not in found]
    if gate.problems or unknown:
        wrong = f"given {', '.join(unknown)}, allowed: {', '.join(found)}"
        raise ValueError("\n".join(gate.problems) or wrong)
    recorded = gate.meta.get("section_hashes") or {}
    print(changes([found[name] for name in names], recorded), end="")
    meta = ROOT / "meta.yaml"
    write_whole(meta, record(meta.read_text("utf-8"), names, found, gate.regions))
    print(f"recorded in meta.yaml: {', '.join(names) or 'what is no longer there is taken out'}")
    return 0


def write() -> int:
    """Make the README's generated blocks anew."""
    from contact import write_whole
    from curriculum.text import readme

    text = readme.README.read_text("utf-8")
    new = readme.fill(text)
    if new != text:
        write_whole(readme.README, new)
    print("README.md: blocks written" if new != text else "README.md: blocks are up to date")
    return 0


def list_numbers() -> int:
    """Print every number of every run, every fact, and every result."""
    from curriculum.text import references, results

    numbers = references.Numbers()
    numbers.run_all()
    for name in numbers.flags():
        show(f"{name}:", numbers.run(name))
    for name in results.FOLDERS:
        show(f"{name}:", results.load(name))
    for name in references.known_facts():
        show(f"fact:{name}.", references.measure(name))
    return 0


def show(prefix, tree):
    """Print every number in nested dicts and lists, one a line, under the name that quotes it."""
    for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
        if isinstance(value, (dict, list)):
            show(f"{prefix}{key}.", value)
        else:
            print(f"{prefix}{key} = {json.dumps(value)}")


if __name__ == "__main__":
    raise SystemExit(main())
