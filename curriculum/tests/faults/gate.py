"""Mutants of curriculum/gate.py, prose/, stored.py, source.py and predict.py: (file, what stands
there, what is planted, the tests that must name it)."""

GATE, REFERENCES = "curriculum/gate.py", "curriculum/prose/references.py"
STORED, RATIOS = "curriculum/stored.py", "curriculum/prose/ratios.py"
ERRORS = "test_gate.py -k test_each_error_of_a_text"
READ = "test_gate.py -k test_a_changed_region"
KEPT = "test_gate.py -k test_what_is_quoted_is_kept"
ROW = "test_gate.py -k test_a_row_of_the_ledger"
STALE = "test_gate.py -k test_results_are_stale"
RATIO = "test_gate.py -k test_a_ratio_in_words"
PREDICT, PAPER = "curriculum/predict.py", "test_predict.py -k as_on_paper"

FAULTS = [
    (GATE, r"[\d¼½¾⅓⅔⅛]", r"[\d]", ERRORS),
    (GATE, r"|\]\([^)]*\)|", r"|\[[^]]*\]\([^)]*\)|", ERRORS),
    (GATE, " + WORD.findall(match[1])", "", ERRORS),
    (GATE, r"|\b[a-z]\w+(?=\()", "", ERRORS),
    (GATE, 'NO_CODE.sub("", read_text(file))', "read_text(file)", ERRORS),
    (GATE, "while COMPUTED.search(text):", "while False:", ERRORS),
    (GATE, "if mark not in placed:", "if False:", ERRORS),
    (GATE, "if was.get(source) != now.get(source)", "if source not in was", ERRORS),
    (GATE, "if was.get(source) != now.get(source)", "if source in was", ERRORS),
    (GATE, "for source in now | was", "for source in now", ERRORS),
    (GATE, "filter(stored.stale, stored.ledger())", "()", ERRORS),
    (GATE, "now if name in names else was.get(name)", "now", READ),
    (GATE, "elif region.defines & words:", "elif False:", READ),
    (GATE, "stored.digits(region.source, region.code)", "region.sha", READ),
    (GATE, 'startswith(("exercises/", CHAPTER))', 'startswith(("exercises/", "c"))', ERRORS),
    (RATIOS, "min(bounds) <= number <= max(bounds)", "bool(bounds)", RATIO),
    (RATIOS, "(value, 1.0 / value)", "(value, 0.5)", RATIO),
    (RATIOS, "start < match.end() <= end", "True", RATIO),
    (REFERENCES, "[inputs, made_by(), ", "[inputs, ", KEPT),
    (REFERENCES, 'version("numpy"), sys.version', "sys.version", KEPT),
    (REFERENCES, "if value is not True:", "if False:", "test_gate.py -k test_a_reference_becomes"),
    (STORED, "{seconds / 60:.3g}", "{seconds:.3g}", ROW),
    (STORED, "is not None :]", "is None :]", STALE),
    (STORED, 'if " " in str(node.value)', "if False", STALE),
    (STORED, "used |= {n.id ", "{n.id ", STALE),
    ("curriculum/__init__.py", "os.kill(int(child), signal.SIGKILL)", "pass",
     "test_gate.py -k leaves_no_run_behind"),
    ("curriculum/source.py", 'dedent(code).rstrip("\\n")', "dedent(code)", READ),
    (PREDICT, "return mass * G / stiffness", "return 1.01 * mass * G / stiffness", PAPER),
    (PREDICT, "(1.0 - 2.0 * zeta * left)", "0.0", PAPER),
    (PREDICT, "- (1.0 - 0.5 * baumgarte)", "- (1.0 - baumgarte)", PAPER),
    (PREDICT, "/ (3.0 - d0)", "/ 3.0", "test_predict.py -k the_command"),
    ("contact.py", "4.0 * math.cos(math.pi / (2 * count + 1)) ** 2", "4.0", PAPER),
]  # fmt: skip
