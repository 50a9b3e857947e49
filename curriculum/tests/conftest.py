"""Shared by the tests: contact.py as a process, and a recording opened again."""

import os
import subprocess
import sys
from collections import namedtuple
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
Recording = namedtuple("Recording", "series static blueprint application")


@pytest.fixture
def run_script():
    """A function that runs `python contact.py FLAGS` and returns the finished process, as bytes."""

    def run(*flags, cwd=ROOT, **environment):
        return subprocess.run(
            [sys.executable, str(ROOT / "contact.py"), *map(str, flags)],
            cwd=cwd,
            env=os.environ | {"PYTHONPATH": str(ROOT)} | environment,
            capture_output=True,
            timeout=120,
        )

    return run


@pytest.fixture
def read_recording():
    """A function that opens an .rrd as it was written, without row ids and times of logging.

    series {entity: {column: [value, ...]}}, rows in order of the timeline step;
    static {entity: {column: value}}; blueprint: the same as static, of all its rows in a list.
    """
    chunk = pytest.importorskip(
        "rerun.chunk", reason="a rerun that can read its recordings is not installed"
    )

    def rows(reader, store):
        dull = ("rerun.controls.RowId", "log_time", "log_tick", "blueprint")
        for part in reader.stream(store=store):
            batch = part.to_record_batch()
            names = [name for name in batch.schema.names if name not in dull]
            values = [
                (
                    batch.column(name).cast("int64").to_pylist()  # nanoseconds
                    if name == "sim_time"
                    else batch.column(name).to_pylist()
                )
                for name in names
            ]
            for row in zip(*values):
                yield part.entity_path, dict(zip(names, row))

    def read(path):
        reader = chunk.RrdReader(str(path))
        (store,) = reader.recordings()
        series, static = {}, {}
        for entity, row in rows(reader, store):
            if entity.startswith("/__properties"):
                continue
            if "step" in row:
                for column, value in row.items():
                    series.setdefault(entity, {}).setdefault(column, []).append(value)
            else:
                static.setdefault(entity, {}).update(row)
        for columns in series.values():
            order = sorted(range(len(columns["step"])), key=columns["step"].__getitem__)
            columns |= {column: [values[k] for k in order] for column, values in columns.items()}
        blueprint = [pair for store in reader.blueprints() for pair in rows(reader, store)]
        return Recording(series, static, blueprint, store.application_id)

    return read
