"""Faults for curriculum/gate/, measured/ and regions.py: (file, what stands there, what is planted,
the tests that must name it)."""

GATE, REFERENCES = "curriculum/gate/__main__.py", "curriculum/gate/references.py"
LEDGER, STALE = "curriculum/measured/ledger.py", "curriculum/measured/stale.py"
ERRORS = "test_gate.py -k test_each_error_of_a_text"
READ = "test_gate.py -k test_a_changed_region"
KEPT = "test_gate.py -k test_what_is_quoted_is_kept"
ROW = "test_gate.py -k 'a_row_shows or whole_row'"
RESULTS = "test_gate.py -k test_results_are_stale"

FAULTS = [
    (GATE, "{file: read_text(file) for file in TEXTS}", "{CHAPTER: self.chapter}", ERRORS),
    (GATE, r"[\d¼½¾⅓⅔⅛]", r"[\d]", ERRORS),
    (GATE, r"|\]\([^)]*\)|", r"|\[[^]]*\]\([^)]*\)|", ERRORS),
    (GATE, "if was != now:", "if False:", ERRORS),
    (GATE, "recorded.get(each.name) != each.sha", "each.name not in recorded", ERRORS),
    (GATE, "if opening := OPENING", "if not OPENING", ERRORS),
    (GATE, " | {each.name: each for each in openings_and_captions()}", "", ERRORS),
    (GATE, r"^[A-Za-z_]\w+$|--[a-z]\w*", r"^[A-Za-z_]\w+$", ERRORS),
    (GATE, r"^[A-Za-z_]\w+$|--[a-z]\w*", r"--[a-z]\w*", ERRORS),
    (GATE, "if not shown[kind, name]:", "if False:", ERRORS),
    ("curriculum/bench/report.py", '"## Whole processes"', '"## Processes"',
     "test_bench.py -k made_of_the_results"),
    (GATE, "if ledger.stale(row):", "if False:", ERRORS),
    (GATE, "or bool(region.defines & words)", "", READ),
    (GATE, "for name in names}\n    hashes", "for name in gate.read}\n    hashes", READ),
    (GATE, 'for file in files("exercises/ex*.py"):\n', "for file in ():\n", READ),
    (REFERENCES, '"seeds", "gate/facts"', '"seeds"', KEPT),
    (REFERENCES, 'version("numpy"), sys.version', "sys.version", KEPT),
    (REFERENCES, "fingerprint(*MADE_BY), ", "", KEPT),
    (REFERENCES, '">=": ge', '">=": gt', "test_gate.py -k test_sentence_in_words"),
    (LEDGER, "statistics.median(seconds[1:])", "min(seconds[1:])", ROW),
    (LEDGER, "seconds[1:]) / 60", "seconds[1:])", ROW),
    (LEDGER, "{60 * taken:.2g} s", "{taken:.2g} s", ROW),
    (STALE, "is not None :]", "is None :]", RESULTS),
    (STALE, 'if " " in s[0]', 'if "  " in s[0]', "test_gate.py -k test_a_change_of_the_command"),
    (STALE, "if read_text(path)]", "if not path]", RESULTS),
    ("curriculum/regions.py", 'dedent(code).rstrip("\\n")', "dedent(code)", READ),
]  # fmt: skip
