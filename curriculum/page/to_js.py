"""Functions of contact.py as JavaScript: the page computes with the very lines that it shows.

to_js(roots, *files) takes what the roots reach. JavaScript's numbers are Python's, and + - * / and
sqrt are rounded alike, so that a run has the same bits. What JavaScript lacks is in `$`: python.js.
"""

import ast

from curriculum.source import needed, stored

FORMS = {  # of a node: its fields in JavaScript
    "Tuple": "[{elts}]", "List": "[{elts}]", "Dict": "new Map({keys})",
    "Subscript": "{value}[{slice}]", "BinOp": "({left} {op} {right})",
    "UnaryOp": "({op}{operand})", "IfExp": "({test} ? {body} : {orelse})",
    "AugAssign": "{target} {op}= {value};", "While": "while ({test}) {body}",
    "If": "if ({test}) {body} else {orelse}",
    "Return": "return {value};", "Yield": "yield {value}",
    "Raise": "throw {exc};", "Break": "break;",
    "Add": "+", "Sub": "-", "Mult": "*", "Div": "/", "Pow": "**", "USub": "-", "Not": "!",
    "Lt": "<", "Gt": ">", "LtE": "<=", "GtE": ">=", "Eq": "===", "NotEq": "!==",
    "Is": "===", "IsNot": "!==", "In": "in", "And": " && ", "Or": " || ",
}  # fmt: skip
NAMES = {"True": "true", "False": "false", "None": "null", "self": "this", "abs": "Math.abs"}
NAMES |= {"int": "Math.trunc", "math.inf": "Infinity", "ArithmeticError": "Error"}
NAMES |= {f"math.{name}": f"Math.{name}" for name in ("sqrt", "cos")}
NAMES |= {name: f"$.{name}" for name in ("zip", "map", "len")}


class Script(ast.NodeVisitor):
    """visit(node) is the node as text. Raises ValueError at what it does not know."""

    def __init__(self, known):
        self.known = known  # {name: (file, node)} of what stands at the top of the files
        self.local, self.file, self.line = set(), "", 0

    def generic_visit(self, node):
        self.line = getattr(node, "lineno", self.line)
        if form := FORMS.get(type(node).__name__):
            parts = {name: part for name, part in ast.iter_fields(node) if name != "ctx"}
            return form.format(**{name: self.part(part, name) for name, part in parts.items()})
        what, place = ast.unparse(node) or type(node).__name__, f"{self.file}:{self.line}"
        raise ValueError(f"{place}: {what!r} is not made into JavaScript; allowed: see to_js.FORMS")

    def part(self, part, name=""):
        if not isinstance(part, list):
            return self.visit(part) if part else ""
        if name in ("body", "orelse"):
            return "{\n" + "".join(self.visit(node) + "\n" for node in part) + "}"
        return ", ".join(map(self.visit, part))

    # ---- statements

    def visit_FunctionDef(self, node):
        names = [arg.arg for arg in node.args.args]
        method = names[:1] == ["self"]
        names = names[method:]
        usual = [""] * (len(names) - len(node.args.defaults))
        usual += [f" = {self.visit(each)}" for each in node.args.defaults]
        local = ", ".join(sorted(stored(node) - set(names)))
        self.local = {*names, *stored(node)}
        body = self.part(node.body, "body").replace(
            "{\n", f"{{\nlet {local};\n" if local else "{\n", 1
        )
        self.local = set()
        name = "constructor" if node.name == "__init__" else node.name
        head = ", ".join(map(str.__add__, names, usual))
        word = "function* " if "yield " in body else "" if method else "function "
        return f"{word}{name}({head}) {body}"

    def visit_ClassDef(self, node):
        methods = [each for each in node.body if isinstance(each, ast.FunctionDef)]
        return f"class {node.name} " + self.part(methods, "body")

    def visit_Assign(self, node):
        self.line, first = node.lineno, node.targets[0]
        if not self.local:
            return f"const {self.visit(first)} = {self.visit(node.value)};"
        if isinstance(first, ast.Subscript):
            return f"$.put({self.part([first.value, first.slice, node.value])});"
        return " = ".join(map(self.visit, [*node.targets, node.value])) + ";"

    def visit_For(self, node):
        to, over, body = self.visit(node.target), node.iter, self.part(node.body, "body")
        called = ast.unparse(over.func) if isinstance(over, ast.Call) else ""
        args = [self.visit(each) for each in over.args] if called else []
        if called == "range":
            first, last = ["0", *args][-2:]
            return f"for (let {to} = {first}; {to} < {last}; {to}++) {body}"
        if called == "itertools.combinations":  # of two
            n = f"{args[0]}.length"
            head = f"for (let $i = 0; $i < {n}; $i++) for (let $j = $i + 1; $j < {n}; $j++)"
            return f"{head} {{\nlet {to} = [{args[0]}[$i], {args[0]}[$j]];\n{body}}}"
        return f"for (let {to} of {self.visit(over)}) {body}"

    def visit_Expr(self, node):
        return "" if isinstance(node.value, ast.Constant) else self.visit(node.value) + ";"

    # ---- expressions

    def visit_Name(self, node):
        return NAMES.get(node.id, node.id)

    def visit_Constant(self, node):
        return NAMES.get(str(node.value), repr(node.value))

    def visit_Attribute(self, node):
        text = ast.unparse(node)
        if text.startswith("contact."):  # in another file
            return node.attr
        return NAMES.get(text) or f"{self.visit(node.value)}.{node.attr}"

    def visit_BoolOp(self, node):
        return f"({self.visit(node.op).join(map(self.visit, node.values))})"

    def visit_Compare(self, node):
        chain = list(map(self.visit, (node.left, *node.comparators)))
        told = zip(chain, map(self.visit, node.ops), chain[1:])
        told = [f"$.has({b}, {a})" if op == "in" else f"{a} {op} {b}" for a, op, b in told]
        return f"({' && '.join(told)})"

    def visit_ListComp(self, node):
        text, over = self.visit(node.elt), "map"
        for each in node.generators[::-1]:
            to = self.visit(each.target)
            tests = "".join(f".filter(({to}) => {self.visit(test)})" for test in each.ifs)
            text = f"{self.visit(each.iter)}{tests}.{over}(({to}) => {text})"
            over = "flatMap"
        return text

    visit_GeneratorExp = visit_ListComp

    def visit_Call(self, node):
        self.line = node.lineno
        name, args = self.visit(node.func), [self.visit(each) for each in node.args]
        defined = self.known.get(name, ("", None))[1]
        if name in ("max", "min"):
            if len(args) == 1:  # of a list, or what it is by default
                more = [self.visit(each.value) for each in node.keywords]
                return f"$.{name}Of({', '.join(args + more)})"
            while len(args) > 1:
                args[:2] = [f"$.{name}({args[0]}, {args[1]})"]
            return args[0]
        for each in node.keywords:  # by place; what is left out takes its default
            place = [arg.arg for arg in defined.args.args].index(each.arg)
            args += ["undefined"] * (place - len(args)) + [self.visit(each.value)]
        if name.endswith(".get"):
            return f"({name}({args[0]}) ?? {args[1]})"
        name = name[: -len("append")] + "push" if name.endswith(".append") else name
        new = isinstance(defined, ast.ClassDef) or name == "Error"
        return f"{'new ' * new}{name}({', '.join(args)})"


def to_js(roots, *files):
    """The module that exports `roots` and all that they reach, of these files (pathlib.Path)."""
    known = needed(roots, *files)
    script, out = Script(known), []
    for script.file, node in known.values():
        out.append(f"export {script.visit(node)}\n")
    return "".join(out)
