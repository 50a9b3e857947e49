"""Mutants of curriculum/gate.py, prose/, stored.py and source.py: (file, what stands there, what is
planted, the tests that must name it)."""

GATE, REFERENCES = "curriculum/gate.py", "curriculum/prose/references.py"
CHAPTER, STORED = "curriculum/prose/chapter.py", "curriculum/stored.py"
ERRORS = "test_gate.py -k test_each_error_of_a_text"
READ = "test_gate.py -k test_a_changed_region"
KEPT = "test_gate.py -k test_what_is_quoted_is_kept"
ROW = "test_gate.py -k test_a_row_of_the_ledger"
STALE = "test_gate.py -k test_results_are_stale"

FAULTS = [
    (GATE, r"[\d¼½¾⅓⅔⅛]", r"[\d]", ERRORS),
    (GATE, r"|\]\([^)]*\)|", r"|\[[^]]*\]\([^)]*\)|", ERRORS),
    (GATE, r"^[A-Za-z_]\w+$|--[a-z]\w*", r"--[a-z]\w*", ERRORS),
    (GATE, "if place and mark not in placed:", "if False:", ERRORS),
    (GATE, "if was.get(source) != now", "if source not in was", ERRORS),
    (GATE, "if was.get(source) != now", "if was.get(source, now) != now", ERRORS),
    (GATE, "filter(stored.stale, stored.ledger())", "()", ERRORS),
    (GATE, "for name in names}", "for name in self.now}", READ),
    (GATE, "if kept.get(n) != right.get(n)]", "if n not in right]", READ),
    (GATE, " or r.defines & words", "", READ),
    (GATE, ".items() if source in now}", ".items()}", ERRORS),
    (GATE, "if own else {}", "if False else {}", ERRORS),
    (CHAPTER, "HTML.finditer(prose)", "()", ERRORS),
    (REFERENCES, "[inputs, made_by(), ", "[inputs, ", KEPT),
    (REFERENCES, 'version("numpy"), sys.version', "sys.version", KEPT),
    (REFERENCES, "if value is not True:", "if False:", "test_gate.py -k test_a_reference_becomes"),
    (STORED, "{seconds / 60:.3g}", "{seconds:.3g}", ROW),
    (STORED, "is not None :]", "is None :]", STALE),
    (STORED, 'if " " in str(node.value)', "if False", STALE),
    (STORED, "used |= {n.id ", "{n.id ", STALE),
    ("curriculum/source.py", 'dedent(code).rstrip("\\n")', "dedent(code)", READ),
]  # fmt: skip
