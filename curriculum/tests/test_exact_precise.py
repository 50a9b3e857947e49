"""exact in 80 bits carries 64 bits of mantissa throughout, and the sweep of piles and towers."""

import json

import numpy as np
import pytest
from mpmath import mp

import contact
from curriculum import exact, measured, readme
from curriculum.stress import exact_report, exact_sweep, jobs, precise_exact

R, G = contact.RADIUS, contact.GRAVITY
needs_80_bits = pytest.mark.skipif(bool(precise_exact.lacking()), reason=precise_exact.lacking())


@pytest.fixture
def fresh():
    """The module in 80 bits, made anew and forgotten at the end, so that a test may change it."""
    precise_exact.module.cache_clear()
    yield precise_exact.module()
    precise_exact.module.cache_clear()


def many_digits(value):
    """A number of 80 bits as mpmath has it, to the last bit."""
    high = float(value)
    return mp.mpf(high) + mp.mpf(float(value - precise_exact.Number(high)))


def slide_and_its_error():
    """The worst error [r] of a ball that slides off a fixed ball for 0.15 s, in 30 digits.

    theta'' = (g / L) sin theta, from theta = 0.5 at rest: a pendulum upside down.
    """
    x, y, length = R * 2 * np.sin(0.5), 0.25 + R * 2 * np.cos(0.5), 0.2
    scene = contact.Scene(
        "slide", np.array([[0.0, x], [0.25, y]]), np.zeros((2, 2)),
        np.array([np.inf, 1.0]), np.array([R, length - R]), 0.0, 0.0,
    )  # fmt: skip
    times = np.array([0.0, 0.0625, 0.125])
    q, _ = precise_exact.simulate_exact(scene, times, G)
    with mp.workdps(30):
        start = mp.atan2(mp.mpf(x), mp.mpf(y) - mp.mpf(0.25))
        reach = mp.mpf(R) + mp.mpf(length - R)
        k = mp.mpf(-G) / reach
        path = mp.odefun(lambda t, s: [s[1], k * mp.sin(s[0])], 0, [start, 0])
        error = mp.mpf(0)
        for time, row in zip(times[1:], q[1:]):
            angle = path(mp.mpf(float(time)))[0]
            error = max(error, abs(many_digits(row[0, 1]) - reach * mp.sin(angle)))
            error = max(error, abs(many_digits(row[1, 1]) - 0.25 - reach * mp.cos(angle)))
        return float(error / mp.mpf(R))


def bounce_and_its_error():
    """The worst height error [r] of a ball that bounces twice, against the parabolas."""
    scene = contact.build_scene("bounce", 0)
    times = np.linspace(0.0, 1.0, 33)
    q, _ = precise_exact.simulate_exact(scene, times, G)
    with mp.workdps(40):
        floor, g, e = (mp.mpf(float(x)) for x in (scene.radius[0], G, scene.restitution))
        y, v, now, error = mp.mpf(float(scene.q0[1, 0])) - floor, mp.mpf(0), mp.mpf(0), mp.mpf(0)
        for time, row in zip(map(mp.mpf, times.tolist()), q):
            while (land := now + (-v - mp.sqrt(v * v - 2 * g * y)) / g) <= time:
                v, y, now = -e * (v + g * (land - now)), mp.mpf(0), land
            s = time - now
            error = max(error, abs(many_digits(row[1, 0]) - floor - y - v * s - g * s * s / 2))
        return float(error / floor)


def errors_in_last_bits():
    """Both errors, each in last bits of 80 at the place of the ball: below 0.5 m, below 1 m."""
    return slide_and_its_error() * R / 2.0**-65, bounce_and_its_error() * R / 2.0**-64


@needs_80_bits
def test_a_slide_and_a_bounce_in_80_bits_are_right_to_a_few_last_bits():
    """8 bits in the slide are 2e-18 r, 16 in the bounces 9e-18 r: 2000 in a double's one."""
    slide, bounce = errors_in_last_bits()
    assert slide < 8 and bounce < 16


DOUBLES = {
    "zeros": ("np", np.zeros),
    "array": ("np", lambda rows: np.array(rows, float)),
    "bincount": ("np", lambda i, rows, count: np.bincount(i, rows.astype(float), count)),
    "sqrt": ("math", lambda x: float(np.sqrt(float(x)))),
}


@needs_80_bits
@pytest.mark.parametrize("name", DOUBLES)
def test_one_double_in_it_shows_in_the_slide_or_the_bounce(fresh, name):
    where, double = DOUBLES[name]
    setattr(getattr(fresh, where), name, double)
    with np.errstate(all="ignore"):
        slide, bounce = errors_in_last_bits()
    assert slide > 8 or bounce > 16, "the test above would fail"


@needs_80_bits
def test_a_pile_in_80_bits_keeps_its_energy_and_has_digits_no_double_has():
    scene, times = contact.build_scene("pile", 0, 8, 0.5), np.linspace(0.0, 1.0, 126)
    q, v = precise_exact.simulate_exact(scene, times, G)
    moves = np.abs(np.diff(q, axis=0)).max(0) > 0.0
    assert q.dtype == v.dtype == precise_exact.Number
    assert (q.astype(float) != q)[1:, moves].mean() > 0.5
    assert np.diff(contact.energy(q, v, scene.mass)).max() <= 1e-17
    doubles, _ = exact.simulate_exact(scene, times, G)
    assert 0.0 < np.abs(q - doubles).max() <= 1e-10 * R


def test_tolerances_are_those_of_the_last_bit_and_choices_stay(fresh):
    for name in ("TOUCH", "LAST", "NOISE", "CUT", "GRAZE"):
        assert getattr(fresh, name) == getattr(exact, name) / 2**11
    for name in ("ORDER", "LONGER", "TICK", "FEW", "ROOM"):
        assert getattr(fresh, name) == getattr(exact, name)
    literals = {x for x in fresh.first_fall.__code__.co_consts if isinstance(x, float) and x > 0.0}
    assert min(literals) == 1e-15 / 2**11


def test_a_machine_without_80_bits_says_so_in_one_line_and_skips_them(monkeypatch):
    monkeypatch.setattr(precise_exact, "Number", np.float64)
    assert precise_exact.lacking() == (
        "no 80 bit numbers here: np.longdouble has 52 bits after the first, not 63"
    )
    found = exact_sweep.pile(3, 0.0, 0)
    assert found["events"] == 7 and "parts" not in found


# the sweep


@needs_80_bits
def test_a_run_parts_where_it_is_1e_8_r_away_and_is_not_followed_much_further():
    """Doubles that are moved by 1.01e-8 r from 0.5 s on part there; by 0.99e-8 r they do not."""
    scene, times = contact.build_scene("pile", 0, 3, 0.0), np.linspace(0.0, 1.0, 1001)
    q, _ = exact.simulate_exact(scene, times, G)
    for share, parts in ((1.01, 0.5), (0.99, None)):
        moved = q + share * 1e-8 * R * (times >= 0.5)[:, None, None]
        found = exact_sweep.beside_80_bits(scene, times, moved)
        assert found["parts"] == parts
        assert found["apart"] == pytest.approx(share * 1e-8)


@needs_80_bits
def test_a_run_of_too_many_events_is_followed_as_far_as_they_last(monkeypatch):
    scene, times = contact.build_scene("pile", 0, 3, 0.5), np.linspace(0.0, 1.0, 1001)
    q, _ = exact.simulate_exact(scene, times, G)
    monkeypatch.setattr(exact_sweep, "MOST", 40)
    found = exact_sweep.beside_80_bits(scene, times, q)
    assert found["precise_events"] == 41 and found["parts"] is None
    assert 0.2 < found["precise_until"] < 1.0 and found["apart"] < 1e-12


@needs_80_bits
def test_a_run_that_is_read_on_its_way_keeps_its_bits():
    scene, times = contact.build_scene("pile", 1, 8, 0.5), np.linspace(0.0, 0.5, 51)
    whole = precise_exact.simulate_exact(scene, times, G)
    seen = []

    def look(samples):
        if samples > 10 * len(seen):
            seen.append(precise_exact.so_far(times)[0].tolist())

    read = precise_exact.simulate_exact(scene, times, G, look)
    assert all((a == b).all() for a, b in zip(read, whole)) and len(seen) > 3
    assert all(part == whole[0][: len(part)].tolist() for part in seen)


def test_the_clock_waits_after_so_many_events_in_a_tick():
    times = np.arange(1001) * 1e-3
    few = exact.EVENTS * 20
    calm = np.repeat(np.arange(1, 1001, 20), few)  # a tick is 10.1 ms
    assert exact_sweep.first_wait(calm.tolist(), 3, times) is None
    dense = np.append(calm, [901])
    assert 0.88 < exact_sweep.first_wait(dense.tolist(), 3, times) <= 0.901


def test_a_pile_of_200_is_stopped_when_its_time_is_over():
    found = exact_sweep.wide(0.05)
    assert found["steps"] < 300 and found["events"] > 0


def test_without_the_first_editions_commit_its_column_is_empty(monkeypatch):
    monkeypatch.setattr(exact_sweep, "FIRST_EDITION", "0123456789abcdef")
    assert "seconds" not in exact_sweep.first(8, 0.0, 0)


@pytest.fixture
def small(monkeypatch, tmp_path):
    """The command on little, in this process, and its folder."""
    little = {"counts": (3,), "seeds": 1, "towers": 1, "tall": 2, "wide": 0.01}
    monkeypatch.setattr(exact_sweep, "SHORT", little)
    monkeypatch.setattr(exact_sweep, "WORK", tmp_path / "kept.jsonl")

    def run(*flags):
        flags = ["--quick", "--workers", "0", "--out", str(tmp_path), *flags]
        assert exact_sweep.main(flags) == 0
        return (tmp_path / "exact.md").read_text("utf-8")

    return run


def test_the_command_writes_a_page_and_goes_on_where_it_stopped(small, monkeypatch, tmp_path):
    page = small()
    section = json.loads((tmp_path / "results.json").read_text("utf-8"))["exact"]
    assert "| 3 | 0.5 |" in page and "not for quoting" in page
    assert len(section["exact-pile"]) == 2 and section["died"] == []
    monkeypatch.setattr(jobs, "run", lambda job: pytest.fail("all of it was kept"))
    assert small() == page and small("--draw") == page


def test_the_page_is_not_drawn_before_anything_is_measured(small, capsys):
    with pytest.raises(SystemExit) as ended:
        small("--draw")
    assert ended.value.code == 2 and "measure first" in capsys.readouterr().err


def test_the_page_names_what_parts_what_waited_and_what_died(small, tmp_path):
    small()
    section = measured.load(tmp_path)["exact"]
    calm = exact_report.whole_page(section)
    assert "2 stay within 1e-8 r" in calm and "(none parts)" in calm and "Did not end" not in calm
    section["exact-pile"][1] |= {"parts": 1.25, "before": 3e-9, "waits": 1.0}
    section["exact-pile"][0] |= {"overlap": 2e-10, "precise_until": 0.75}
    section["died"] = ["pile of 9"]
    page = exact_report.whole_page(section)
    for words in (
        "the first parts at 1.25 s", "In 1 of the runs that part", "2.0e-10 r | **missed**",
        "the shortest to 0.750 s", "Did not end: pile of 9", "2 of them were run in 80 bits as well: 0 stay", "1 as far as",
    ):  # fmt: skip
        assert words in page + exact_report.readme_block(section)


def test_the_kept_page_is_made_from_the_kept_numbers():
    kept = measured.load(exact_sweep.RESULTS)
    if "exact" not in kept:
        pytest.skip("not measured yet")
    page = exact_sweep.RESULTS / "exact.md"
    assert page.read_text("utf-8") == exact_report.whole_page(kept["exact"])
    assert readme.block("exact").endswith(exact_report.readme_block(kept["exact"]) + "\n")
