"""Many rows with the same keys, kept small: the keys once, then one list per row."""


def pack(rows) -> dict:
    """{"columns": [...], "rows": [[...]]} of dicts with the same keys; floats keep four digits."""
    columns = list(rows[0]) if rows else []
    return {"columns": columns, "rows": [[_short(row[name]) for name in columns] for row in rows]}


def unpack(packed) -> list:
    """The dicts again."""
    return [dict(zip(packed["columns"], row)) for row in packed["rows"]]


def _short(value):
    return float(f"{value:.4g}") if isinstance(value, float) else value


def front(points, across, up) -> list:
    """The points that no other beats in both keys at once, by rising `across`: the Pareto front."""
    best, found = float("inf"), []
    for point in sorted(points, key=lambda p: (p[across], p[up])):
        if point[up] < best:
            best = point[up]
            found.append(point)
    return found
