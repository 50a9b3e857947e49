"""Runs as a rerun recording: a view of balls for every model, curves below.

rerun's 2-D views have y down and no option, so y is negated here and nowhere else.
Raises ImportError on import where rerun is missing.
"""

import os
import tempfile
from functools import partial
from pathlib import Path

import numpy as np

import contact
from curriculum import commands
from curriculum.show.picture import COLORS, contact_impulses, curves

try:
    import rerun as rr
    import rerun.blueprint as rrb
except ImportError:
    raise ImportError(commands.to_install("rerun-sdk")) from None

PUSH = "#f0e442"  # colour of the arrows
GROUND, LINE = "#3a3f4a", "#ffffff"
MOST_ARROWS = 24  # balls: more have no arrows
SECONDS = ("sim_time", "landing")  # timelines, besides step
LONGEST = 9e9  # s: 64 bits of nanoseconds
BEFORE = 0.1  # s: how long before the first contact the recording opens
FARTHEST = 150  # radii: how far out of the middle a ball is still kept in view
MAGNIFIED = 0.16  # radii: the height of the view of the table, where a rest sinks by 0.01


def write(path: str, runs: dict, scene: contact.Scene, quality: dict, title: str) -> None:
    """Write the runs {model: Run} of a scene as a recording, whole or not at all.

    quality: {model: contact_quality} of the runs. A recording shows no title. Whole columns are
    sent, in rerun's strict mode. The timelines are step, sim_time (up to 9e9 s), and landing, which
    it opens on: sim_time, but all that is long before the first contact at its start. The entities
    are world/MODEL/{ground,table,balls,pushes} and CURVE/MODEL.
    """
    rr.set_strict_mode(True)  # a wrong call raises instead of warning
    drawn, seconds = curves(runs, scene), worth_seeing(runs, quality)
    times = {model: timelines(run.t, seconds[0]) for model, run in runs.items()}
    recording = rr.RecordingStream("contact")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        temporary = Path(folder, os.path.basename(path))
        recording.save(temporary, default_blueprint=layout(runs, scene, drawn, seconds, quality))
        for model, run in runs.items():
            send_table(recording, model)
            send_balls(recording, model, run, scene, times[model])
        send_curves(recording, runs, drawn, times)
        recording.disconnect()
        commands.write_whole(path, temporary.read_bytes())


def rgba(color: str) -> np.ndarray:
    """The colour "#rrggbb" as rerun stores it."""
    return np.array([int(color[1:] + "ff", 16)], np.uint32)


def timelines(t: np.ndarray, first: float) -> list:
    """The columns of time; those in seconds where 64 bits of nanoseconds can hold them."""
    times = [rr.TimeColumn("step", sequence=np.arange(len(t)))]
    if t[-1] < LONGEST:
        for name, seconds in zip(SECONDS, (t, np.maximum(t, first))):
            nanoseconds = np.round(seconds * 1e9).astype("timedelta64[ns]")  # no stamp is off
            times.append(rr.TimeColumn(name, duration=nanoseconds))
    return times


def send_table(recording, model):
    """The table: a grey body under the balls, and a thin line over them, so that a sink is seen.

    The body is made of lines of five radii, each with its upper edge at y = 0, since an old viewer
    (0.26) draws a thick line thinner by a hundredth, which left a gap under the thin one.
    """
    wide = 50.0  # m; a longer line is drawn with gaps where it is magnified
    depths = [0.005, 0.05, 0.5, 5.0, 50.0]
    ground = "ground", depths, depths, GROUND, -10.0
    table = "table", [0.0], [rr.Radius.ui_points(0.6)], LINE, 40.0
    for name, below, radii, color, order in (ground, table):
        lines = [[[-wide, depth], [wide, depth]] for depth in below]
        shown = rr.LineStrips2D(lines, colors=rgba(color), radii=radii, draw_order=order)
        recording.log(f"world/{model}/{name}", shown, static=True)


def send_balls(recording, model, run, scene, times):
    """The balls, where the run had them, and the push on each as an arrow from its centre."""
    count, rows = len(scene.radius), [len(scene.radius)] * len(run.t)
    color = np.repeat(rgba(COLORS[model]), count)
    look = rr.Points2D.from_fields(radii=scene.radius, colors=color, draw_order=20.0)
    columns = rr.Points2D.columns(positions=flat(run.q)).partition(rows)
    send(recording, f"world/{model}/balls", look, times, columns)
    if count > MOST_ARROWS:
        return
    color = np.repeat(rgba(PUSH), count)
    look = rr.Arrows2D.from_fields(radii=0.06 * scene.radius, colors=color, draw_order=30.0)
    arrows = rr.Arrows2D.columns(origins=flat(run.q), vectors=flat(arrow_vectors(run, scene)))
    send(recording, f"world/{model}/pushes", look, times, arrows.partition(rows))


def send(recording, entity: str, look, times, columns) -> None:
    """An entity: its look, once, and what changes of it, a row a step."""
    recording.log(entity, look, static=True)
    recording.send_columns(entity, times, columns)


def flat(rows: np.ndarray) -> np.ndarray:
    """Vectors (S, 2, N) as a list (S N, 2) with y down, in 32 bits, which is what rerun keeps."""
    with np.errstate(over="ignore"):
        return np.stack((rows[:, 0], -rows[:, 1]), axis=-1).reshape(-1, 2).astype(np.float32)


@np.errstate(all="ignore")
def arrow_vectors(run: contact.Run, scene: contact.Scene) -> np.ndarray:
    """Arrows (S, 2, N) along the pushes, r log2(1 + push / weight) long [m].

    So a ball at rest has an arrow as long as its radius, and an impact still fits in the view.
    """
    weight = -contact.GRAVITY * scene.mass * np.diff(run.t[:2]).sum()
    pushes = contact_impulses(run, scene) / weight
    size = np.hypot(pushes[:, 0], pushes[:, 1])
    drawn = (size > 1e-6) & np.isfinite(size)
    length = scene.radius * np.log2(1.0 + size)
    return np.where(drawn[:, None], pushes * (length / size)[:, None], 0.0)


def send_curves(recording, runs: dict, drawn: dict, times: dict) -> None:
    """The curves {title: {model: values}}, each at the title's first word / MODEL."""
    for place, model in enumerate(sorted(runs, reverse=True)):
        width = 1.2 * 1.5**place  # points: lines that coincide are seen beneath
        line = {"colors": rgba(COLORS[model]), "names": model, "widths": width}
        look = rr.SeriesLines(**line, aggregation_policy="MinMax")  # an average hides the peaks
        for title, lines in drawn.items():
            columns = rr.Scalars.columns(scalars=lines[model])
            send(recording, f"{title.split()[0]}/{model}", look, times[model], columns)


def layout(runs, scene, drawn, seconds: tuple, quality: dict) -> rrb.Blueprint:
    """The blueprint that travels in the file: the balls, the table magnified, the plots.

    Every run has views of its own, so balls that roll far never cross into another run's. Where
    they roll, the views are as wide as the screen, one below the other; where they stand above one
    another, the table is magnified under them. A run that explodes does not widen the views, unless
    all do.
    """
    large, x = float(scene.radius.max()), scene.q0[0]
    calm = [run for model, run in runs.items() if not quality[model]["blew_up"]]
    shown = frame(calm or list(runs.values())[:1], x, large)
    lanes = [view(model, title_of(model, row), *shown) for model, row in quality.items()]
    wide = np.ptp(shown[0]) > 1.2 * np.ptp(shown[1])
    rows = [rrb.Vertical(*lanes) if wide else rrb.Horizontal(*lanes)]
    if np.ptp(x) < large and not wide:
        high, middle = MAGNIFIED * large, float(x[0])
        near = [middle - 1.2 * high, middle + 1.2 * high], [-0.4 * high, 0.6 * high]
        name = f"the table, magnified: {MAGNIFIED:g} r high"
        rows.append(rrb.Horizontal(*[view(model, name, *near) for model in runs]))
    rows.append(rrb.Horizontal(*[plot(title, *seconds) for title in drawn]))
    shares = [5, 2, 3] if len(rows) == 3 else [5, 3]
    views = rrb.Vertical(*rows, row_shares=shares)
    return rrb.Blueprint(views, time_panel(), collapse_panels=True)


def title_of(model: str, row: dict) -> str:
    """A model's name, and how its run ended where that was badly."""
    return f"{model}: {contact.ending(row)}" if row["blew_up"] or row["through"] else model


def view(model: str, name: str, x_range: list, y_range: list) -> rrb.Spatial2DView:
    """A view of what a model's balls do in these ranges of x and of -y [m]."""
    bounds = rrb.VisualBounds2D(x_range=x_range, y_range=y_range)
    return rrb.Spatial2DView(origin=f"world/{model}", name=name, visual_bounds=bounds)


def frame(runs: list, x: np.ndarray, large: float) -> tuple[list, list]:
    """The ranges of x and of -y [m] that hold all balls of the runs, from first to last.

    A ball that leaves by more than FARTHEST radii is let go, or the others would be dots.
    """
    middle = 0.5 * (float(x.min()) + float(x.max()))
    half = max(reach(run.q[:, 0] - middle, large) for run in runs) + 2.5 * large
    top = max(reach(run.q[:, 1], large) for run in runs) + 2.0 * large
    return [middle - half, middle + half], [-top, 0.12 * top]


def reach(values: np.ndarray, large: float) -> float:
    """The largest of the values by size [m], at most FARTHEST radii, also if one is not finite."""
    return float(np.fmin(np.abs(values), FARTHEST * large).max())


@np.errstate(all="ignore")
def worth_seeing(runs: dict, quality: dict) -> tuple[float, float]:
    """From when to when [s]: BEFORE the first contact, to when the last ball has come to rest.

    It rests once it goes slower than 1 cm/s for good, judged by its way, since speeds at the end of
    leapfrog's steps may be larger; a tenth more is shown, at most to the end.
    """
    struck, rests = [], [0.0]
    for model, run in runs.items():
        touched = quality[model]["first_contact_step"]
        struck += run.t[touched : touched + 1].tolist()
        slow = np.abs(np.diff(run.q, axis=0)) < 0.01 * np.diff(run.t)[:, None, None]
        moving = np.flatnonzero(~slow.all((1, 2)))
        rests += [run.t[min(len(run.t) - 1, k + k // 10 + 1)] for k in moving[-1:]]
    return max(0.0, min(struck, default=0.0) - BEFORE), float(max(rests))


def plot(title: str, first: float, last: float) -> rrb.TimeSeriesView:
    """A plot of these seconds. One has the legend, which hides least where impulses are over."""
    name = title.split()[0]
    legend = rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=name == "impulse")
    shown = None
    if first < last < LONGEST:  # all that was before stands on the first instant: left out
        start, end = (rrb.TimeRangeBoundary.absolute(seconds=each) for each in (first + 1e-6, last))
        shown = [rrb.VisibleTimeRange(line, start=start, end=end) for line in SECONDS]
    return rrb.TimeSeriesView(origin=name, name=title, plot_legend=legend, time_ranges=shown)


def time_panel():
    """Opens on the landing, four times slowed down. rerun-sdk before 0.28 plays it at once."""
    panel = partial(rrb.TimePanel, timeline="landing", state="collapsed")
    try:
        return panel(play_state="paused", playback_speed=0.25)
    except TypeError:
        return panel(duration_cursor=0.0)
