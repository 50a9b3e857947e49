"""contact.py's own functions as loops over tables, for numba: a step is written once.

Balls and contacts become numbers of rows: where the lesson says `c.target` the loops say
`CONTACTS[c].target`, `c.a.vx` is `BALLS[CONTACTS[c].a].vx`, and FLOOR is the last row of BALLS.
Every function is given these tables first, in W. A list of contacts is an array of numbers, a
method a function; max and min are Python's own also where a value is NaN; itertools.combinations
gives the pairs that are near instead of all, in the same order. All else stays as it stands.

What the loops cannot say is refused with its line in contact.py and with what can be written
instead.
"""

import ast
import math
from pathlib import Path

import contact

BALL = [name for name in contact.Ball.__slots__ if name != "pushed"]
CONTACT = list(contact.Contact.__slots__)
METHOD = "contact_"  # c.push(x) becomes contact_push(W, c, x)
KNOWN = "abs bool enumerate float int len max min range zip Contact".split()  # beside math's own
GIVEN = ("warm_start", "remember")  # written by hand in rows.py, over a table of impulses
INSTEAD = {  # what is refused: what to write
    ast.GeneratorExp: "a loop",
    ast.SetComp: "a mark on the balls, or a loop",
    ast.DictComp: "a loop",
    ast.Set: "a mark on the balls",
    ast.Dict: "a field of Ball or Contact",
    ast.Lambda: "a function of its own",
    ast.Starred: "the values one by one",
    ast.NamedExpr: "an assignment on a line of its own",
    ast.With: "nothing around the loops",
    ast.Try: "a test before it",
    ast.JoinedStr: "no text in a step",
    ast.Global: "an argument",
}


class Refused(ValueError):
    """A step that cannot be made into loops; says where, and what to write instead."""


def functions(tree) -> dict:
    """{name: definition} of a file's functions, the methods of Ball and Contact among them."""
    found = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    for owner in tree.body:
        if isinstance(owner, ast.ClassDef) and owner.name == "Contact":
            for method in (each for each in owner.body if isinstance(each, ast.FunctionDef)):
                found["Contact" if method.name == "__init__" else method.name] = method
    return found


def called(node) -> str:
    """The name of the function or method of a call."""
    return getattr(node.func, "attr", None) or getattr(node.func, "id", "")  # type: ignore


def needed(step, found) -> dict:
    """{name: definition} of what a step calls, directly or not, itself among them."""
    reached, look = {}, [step]
    while look:
        name = look.pop()
        if name in found and name not in reached and name not in GIVEN:
            reached[name] = found[name]
            look += [called(node) for node in ast.walk(found[name]) if isinstance(node, ast.Call)]
    return reached


class Rows(ast.NodeTransformer):
    """Objects to rows of tables, in one function. `ours`: names of functions that are given W."""

    def __init__(self, ours):
        self.ours = ours

    def generic_visit(self, node):
        if instead := INSTEAD.get(type(node)):
            words = ast.unparse(node).splitlines()[0]
            raise Refused(f"line {node.lineno}: {words}: no loop can say it; write {instead}")
        return super().generic_visit(node)

    def visit_FunctionDef(self, node):
        if ast.get_docstring(node):
            del node.body[0]
        self.lists = set()
        arguments = [ast.arg("W"), *(ast.arg(each.arg) for each in node.args.args)]
        if node.name == "__init__":  # of a contact: the next row
            del arguments[1]
            head = "self = next_row(W)"
            node.body.append(ast.parse("return self").body[0])
        else:
            head = ""
        args = ast.arguments([], arguments, defaults=[self.visit(d) for d in node.args.defaults])
        args.kwonlyargs, args.kw_defaults = [], []
        head = ast.parse(
            f"BALLS, CONTACTS, FLOOR = W.balls, W.contacts, len(W.balls) - 1\n{head}"
        ).body
        name = METHOD + node.name if arguments[1:2] and arguments[1].arg == "self" else node.name
        name = "Contact" if node.name == "__init__" else name
        body = [*head]
        for each in map(self.visit, node.body):
            body += each if isinstance(each, list) else [each]
        return ast.FunctionDef(name, args, body, [], type_params=[])

    def visit_Attribute(self, node):
        self.generic_visit(node)
        table = "BALLS" if node.attr in BALL else "CONTACTS" if node.attr in CONTACT else None
        if table is None:
            if getattr(node.value, "id", "") == "math":
                return node
            raise Refused(f"line {node.lineno}: .{node.attr} is no field of Ball or Contact")
        row = ast.Subscript(ast.Name(table, ast.Load()), node.value, ast.Load())
        return ast.Attribute(row, node.attr, node.ctx)

    def visit_Compare(self, node):
        self.generic_visit(node)
        same = {ast.Is: ast.Eq(), ast.IsNot: ast.NotEq()}  # a ball is its row
        node.ops = [same.get(type(op), op) for op in node.ops]
        return node

    def visit_Assign(self, node):
        if isinstance(node.value, ast.ListComp):
            return self.choose(node)
        if ast.unparse(node.value) == "[]":  # of contacts: an array with room for all of them
            name = ast.unparse(node.targets[0])
            self.lists.add(name)
            return ast.parse(f"{name}, {name}_size = room(W), 0").body
        return self.generic_visit(node)

    def visit_ListComp(self, node):
        words = ast.unparse(node).splitlines()[0]
        raise Refused(f"line {node.lineno}: {words}: write a loop, or choose: x = [c for c in ...]")

    def choose(self, node):
        """chosen = [c for c in contacts if ...] as a loop that fills an array."""
        name, loop = ast.unparse(node.targets[0]), node.value.generators[0]
        if ast.unparse(node.value.elt) != ast.unparse(loop.target) or len(loop.ifs) != 1:
            self.visit_ListComp(node.value)
        each, of = ast.unparse(loop.target), ast.unparse(loop.iter)
        test = ast.unparse(self.visit(loop.ifs[0]))
        return ast.parse(
            f"{name}, {name}_size = room(W), 0\n"
            f"for {each} in {of}:\n"
            f"    if {test}:\n"
            f"        {name}[{name}_size] = {each}\n"
            f"        {name}_size += 1\n"
            f"{name} = {name}[:{name}_size]"
        ).body

    def visit_Expr(self, node):
        call = node.value
        if isinstance(call, ast.Call) and called(call) == "append":
            name = ast.unparse(call.func.value)
            value = ast.unparse(self.visit(call.args[0]))
            return ast.parse(f"{name}[{name}_size] = {value}\n{name}_size += 1").body
        return self.generic_visit(node)

    def visit_Return(self, node):
        self.generic_visit(node)
        name = getattr(node.value, "id", "")
        return ast.parse(f"return {name}[:{name}_size]").body[0] if name in self.lists else node

    def visit_Call(self, node):
        name = called(node)
        if name == "combinations":
            return ast.parse("zip(W.pairs[0], W.pairs[1])", mode="eval").body
        of_math = ast.unparse(node.func) == f"math.{name}" and hasattr(math, name)
        if not (of_math or name in self.ours or name in KNOWN):
            words = ast.unparse(node.func)
            instead = "math's own, or a function of contact.py"
            raise Refused(f"line {node.lineno}: {words}(): no loop can say it; write {instead}")
        owner = []
        if isinstance(node.func, ast.Attribute) and name in self.ours:  # a method
            owner = [self.visit(node.func.value)]
            node.func = ast.Name(METHOD + name, ast.Load())
        self.generic_visit(node)
        if name in ("max", "min"):
            return self.extreme(node, "larger" if name == "max" else "smaller")
        if name in self.ours:
            node.args = [ast.Name("W", ast.Load()), *owner, *node.args]
        return node

    def extreme(self, node, function):
        """Python's max or min of some values, two by two."""
        value, *others = node.args
        for other in others:
            value = ast.Call(ast.Name(function, ast.Load()), [value, other], [])
        return value


def loops(step: str, source: str | None = None) -> str:
    """Python source of a step and of all that it calls, as loops over tables; constants as numbers.

    Raises Refused, with the line of contact.py and what to write instead.
    """
    source = source or Path(contact.__file__).read_text("utf-8")
    reached = needed(step, functions(ast.parse(source)))
    ours = {*reached, *GIVEN}
    text = [ast.unparse(ast.fix_missing_locations(Rows(ours).visit(f))) for f in reached.values()]
    used = {n.id for f in reached.values() for n in ast.walk(f) if isinstance(n, ast.Name)}
    fixed = [name for name in sorted(used) if name.isupper() and name != "FLOOR"]
    numbers = [f"{name} = {getattr(contact, name)!r}" for name in fixed if hasattr(contact, name)]
    return "\n\n\n".join(["\n".join(numbers), *text]) + "\n"
