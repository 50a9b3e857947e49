"""Translate contact.py's own functions to loops over tables, for numba: a step is written once.

Balls and contacts become numbers of rows: where the lesson says `c.target` the loops say
`CONTACTS[c].target`, `c.a.vx` is `BALLS[CONTACTS[c].a].vx`, and FLOOR is the last row of BALLS.
Every function is given these tables first, in W; a method is a function, and a call gives every
parameter. A list of contacts that is complete becomes an array, and add_contacts makes it a list
again; max and min are Python's own also where a value is NaN; itertools.combinations gives the
pairs that are near instead of all, in the same order. All else stays as it stands.
"""

import ast
import functools
import math
from pathlib import Path

import contact
from curriculum.source import needed

BALL = [name for name in contact.Ball.__slots__ if name != "cached_lam"]
CONTACT = list(contact.Contact.__slots__)
FLOOR_ROW = "np.uint32(len(W.balls) - 1)"  # of the type of all rows
TABLES = {"BALLS": "W.balls", "CONTACTS": "W.contacts", "FLOOR": FLOOR_ROW}
METHOD = "contact_"  # c.apply_impulse(x) becomes contact_apply_impulse(W, c, x)
KNOWN = {"": "abs bool enumerate float int len range zip".split(), "math": dir(math)}
EXTREMES = {"max": "larger", "min": "smaller"}
GIVEN = ("warm_start", "store_impulses")  # written by hand in rows.py
REFUSED = (ast.GeneratorExp, ast.SetComp, ast.DictComp, ast.Set, ast.Dict, ast.Lambda, ast.Starred,
           ast.NamedExpr, ast.With, ast.Try, ast.JoinedStr, ast.Global)  # fmt: skip
INSTEAD = "write loops over balls and contacts, fields of Ball and Contact, functions of numbers"


class Refused(ValueError):
    """A step that cannot be made into loops; says where, and what to write instead."""

    def __init__(self, node):
        words = ast.unparse(node).splitlines()[0]
        super().__init__(f"contact.py:{node.lineno}: {words}: no loop can say it; {INSTEAD}")


class Rows(ast.NodeTransformer):
    """Objects to rows of tables. ours: {function or method that is given W: its parameters}."""

    def __init__(self, ours):
        self.ours = ours

    def generic_visit(self, node):
        if isinstance(node, REFUSED):
            raise Refused(node)
        return super().generic_visit(node)

    def visit_FunctionDef(self, node):
        names = [arg.arg for arg in node.args.args]
        head = ""
        if node.name == "__init__":  # of a contact: the next row
            node.name, names = "Contact", names[1:]
            head = "self = np.uint32(min(W.count[0], len(W.contacts) - 1))\nW.count[0] += 1"
            node.body.append(ast.parse("return self").body[0])
        elif "self" in names:
            node.name = METHOD + node.name
        node.args.args, node.args.defaults = [ast.arg(name) for name in ("W", *names)], []
        node.returns = None
        self.lists = set()
        if node.name == "add_contacts":  # balls stand up to half of `farthest` off their places
            head = "contacts = list(contacts)\nW.farthest[0] = 2.0 * distance"
            self.lists = {"contacts"}
        node.body[: 1 if ast.get_docstring(node) else 0] = []
        self.generic_visit(node)
        used = {each.id for each in ast.walk(node) if isinstance(each, ast.Name)} & {*TABLES}
        tables = [f"{name} = {TABLES[name]}\n" for name in TABLES if name in used]
        node.body[:0] = ast.parse("".join(tables) + head).body
        return node

    def visit_Attribute(self, node):
        self.generic_visit(node)
        if ast.unparse(node.value) == "math":
            return node
        table = "BALLS" if node.attr in BALL else "CONTACTS" if node.attr in CONTACT else None
        if table is None:
            raise Refused(node)
        row = ast.Subscript(ast.Name(table, ast.Load()), node.value, ast.Load())
        return ast.Attribute(row, node.attr, node.ctx)

    def visit_Compare(self, node):
        same = {ast.Is: ast.Eq(), ast.IsNot: ast.NotEq()}  # a ball is its row
        node.ops = [same.get(type(op), op) for op in node.ops]
        return self.generic_visit(node)

    def visit_Assign(self, node):
        if ast.unparse(node.value) == "[]":
            self.lists.add(node.targets[0].id)
        return self.generic_visit(node)

    def visit_ListComp(self, node):
        return as_array(self.generic_visit(node))

    def visit_Return(self, node):
        self.generic_visit(node)
        if getattr(node.value, "id", "") in self.lists:
            node.value = as_array(node.value)
        return node

    def visit_Call(self, node):
        owner, _, name = ast.unparse(node.func).rpartition(".")
        if name == "combinations":
            return ast.parse("zip(W.pairs[0], W.pairs[1])", mode="eval").body
        node.args, node.keywords = [[*map(self.visit, at)] for at in (node.args, node.keywords)]
        if name in self.ours:
            self_ = [self.visit(node.func.value)] if owner else []
            given = dict(zip(self.ours[name], node.args)) | {k.arg: k.value for k in node.keywords}
            values = (self.ours[name] | given).values()  # all of them, in their order
            node.args, node.keywords = [ast.Name("W"), *self_, *values], []
            node.func = ast.Name(METHOD * len(self_) + name)
        elif name in EXTREMES and not owner:  # two by two
            function = ast.Name(EXTREMES[name])
            return functools.reduce(lambda a, b: ast.Call(function, [a, b], []), node.args)
        elif name not in KNOWN.get(owner, ["append"]):
            raise Refused(node)
        return node


def parameters(function):
    """Return {parameter: its default or None} of a function or a method, without self."""
    names = [each.arg for each in function.args.args if each.arg != "self"]
    defaults = function.args.defaults
    return dict(zip(names, [None] * (len(names) - len(defaults)) + defaults))


def as_array(node):
    """Return the call that makes an array of a list."""
    return ast.Call(ast.Name("np.array"), [node], [])


def loops(step: str, file=Path(contact.__file__)) -> str:
    """Return a step and all that it calls as source of loops over tables, constants as numbers.

    Raises Refused, with the line of contact.py and what to write instead.
    """
    numbers, functions = [], {}
    for name, (_, node) in needed([step], file).items():
        if isinstance(node, ast.FunctionDef):
            functions[name] = node
        elif name == "Contact":
            methods = [each for each in node.body if isinstance(each, ast.FunctionDef)]
            functions |= {each.name.replace("__init__", name): each for each in methods}
        elif type(getattr(contact, name, None)) in (int, float):
            numbers.append(f"{name} = {getattr(contact, name)!r}")
    rows = Rows({name: parameters(node) for name, node in functions.items()})
    texts = [ast.unparse(rows.visit(functions[name])) for name in functions if name not in GIVEN]
    return "\n".join(numbers + [f"\n\n{text}" for text in texts])
