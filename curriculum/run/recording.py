"""Runs as a rerun recording: a view of balls for every model, curves below.

rerun's 2-D views have y down and no option, so y is negated here and nowhere else.
Raises ImportError on import where rerun is missing.
"""

import os
import tempfile
from pathlib import Path

import numpy as np

import contact
from curriculum import commands
from curriculum.files import write_whole
from curriculum.run.curves import colors, contact_impulses, curves, ending

try:
    import rerun as rr
    import rerun.blueprint as rrb
except ImportError:
    raise ImportError(commands.to_install("rerun-sdk")) from None

PUSH = "#f0e442"  # colour of the arrows
GROUND, LINE = "#3a3f4a", "#ffffff"
WIDTHS = (6.0, 3.6, 2.2, 1.2)  # of curves, in points: lines that coincide are seen beneath
MOST_ARROWS = 24  # balls: more have no arrows
FARTHEST = 150  # radii: how far out of the middle a ball is still kept in view
MAGNIFIED = 0.16  # radii: the height of the view of the table, where a rest sinks by 0.01


def write(path, runs, scene):
    """Write the runs {model: Run} of a scene as a recording, whole or not at all.

    A run that is no model's may have any name of [a-z0-9_.]. Whole columns are sent, in rerun's
    strict mode. The timelines are step and sim_time (up to 9e9 s). The entities are
    world/MODEL/{ground,table,balls,pushes} and CURVE/MODEL.
    """
    rr.set_strict_mode(True)  # a wrong call raises instead of warning
    drawn = curves(runs, scene)
    recording = rr.RecordingStream("contact")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        temporary = Path(folder, os.path.basename(path))
        recording.save(temporary, default_blueprint=layout(runs, scene, drawn))
        for model, run in runs.items():
            send_table(recording, model)
            send_balls(recording, model, run, scene, colors(runs)[model])
        send_curves(recording, runs, drawn)
        recording.disconnect()
        write_whole(path, temporary.read_bytes())


def rgba(color):
    """The colour "#rrggbb" as rerun stores it."""
    return np.array([int(color[1:] + "ff", 16)], np.uint32)


def timelines(t):
    """The columns of time: step, and sim_time where 64 bits of nanoseconds can hold it."""
    times = [rr.TimeColumn("step", sequence=np.arange(len(t)))]
    if t[-1] < 9e9:
        nanoseconds = np.round(t * 1e9).astype("timedelta64[ns]")  # whole: no stamp is off
        times.append(rr.TimeColumn("sim_time", duration=nanoseconds))
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


def send_balls(recording, model, run, scene, color):
    """The balls, where the run had them, and the push on each as an arrow from its centre."""
    count, times = len(scene.radius), timelines(run.t)
    rows = [count] * len(run.t)
    look = rr.Points2D.from_fields(
        radii=scene.radius, colors=np.repeat(rgba(color), count), draw_order=20.0
    )
    columns = rr.Points2D.columns(positions=flat(run.q)).partition(rows)
    send(recording, f"world/{model}/balls", look, times, columns)
    if count > MOST_ARROWS:
        return
    look = rr.Arrows2D.from_fields(
        radii=0.06 * scene.radius, colors=np.repeat(rgba(PUSH), count), draw_order=30.0
    )
    arrows = rr.Arrows2D.columns(origins=flat(run.q), vectors=flat(arrow_vectors(run, scene)))
    send(recording, f"world/{model}/pushes", look, times, arrows.partition(rows))


def send(recording, entity, look, times, columns):
    """An entity: its look, once, and what changes of it, a row a step."""
    recording.log(entity, look, static=True)
    recording.send_columns(entity, times, columns)


def flat(rows):
    """Vectors (S, 2, N) as a list (S N, 2) with y down, in 32 bits, which is what rerun keeps."""
    with np.errstate(over="ignore"):
        return np.stack((rows[:, 0], -rows[:, 1]), axis=-1).reshape(-1, 2).astype(np.float32)


@np.errstate(all="ignore")
def arrow_vectors(run, scene):
    """Arrows (S, 2, N) along the pushes, r log2(1 + push / weight) long [m].

    So a ball at rest has an arrow as long as its radius, and an impact still fits in the view.
    """
    weight = -contact.GRAVITY * scene.mass * np.diff(run.t[:2]).sum()
    pushes = contact_impulses(run, scene) / weight
    size = np.hypot(pushes[:, 0], pushes[:, 1])
    drawn = (size > 1e-6) & np.isfinite(size)
    length = scene.radius * np.log2(1.0 + size)
    return np.where(drawn[:, None], pushes * (length / size)[:, None], 0.0)


def send_curves(recording, runs, drawn):
    """The curves {title: {model: values}}, each at the title's first word / MODEL."""
    for width, model in zip(WIDTHS[-len(runs) :], sorted(runs)):
        times = timelines(runs[model].t)
        look = rr.SeriesLines(
            colors=rgba(colors(runs)[model]),
            names=[model],
            widths=width,
            aggregation_policy="MinMax",  # an average hides the peaks
        )
        for title, lines in drawn.items():
            columns = rr.Scalars.columns(scalars=lines[model])
            send(recording, f"{title.split()[0]}/{model}", look, times, columns)


def layout(runs, scene, drawn):
    """The blueprint that travels in the file: the balls, the table magnified, the plots, at t = 0.

    Every run has views of its own, so balls that roll far never cross into another run's. Where
    they roll, the views are as wide as the screen, one below the other; where they stand above one
    another, the table is magnified under them. A run that explodes does not widen the views, unless
    all do.
    """
    large, x = float(scene.radius.max()), scene.q0[0]
    ends = {model: ending(run, scene) for model, run in runs.items()}
    calm = [run for model, run in runs.items() if "EXPLODED" not in ends[model]]
    shown = frame(calm or list(runs.values())[:1], x, large)
    lanes = [
        view(model, model if end == "ok" else f"{model}: {end}", *shown)
        for model, end in ends.items()
    ]
    wide = np.ptp(shown[0]) > 1.2 * np.ptp(shown[1])
    rows = [rrb.Vertical(*lanes) if wide else rrb.Horizontal(*lanes)]
    if np.ptp(x) < large and not wide:
        high, middle = MAGNIFIED * large, float(x[0])
        near = [middle - 1.2 * high, middle + 1.2 * high], [-0.4 * high, 0.6 * high]
        name = f"the table, magnified: {MAGNIFIED:g} r high"
        rows.append(rrb.Horizontal(*[view(model, name, *near) for model in runs]))
    rows.append(rrb.Horizontal(*[plot(title, settled_at(runs)) for title in drawn]))
    shares = [5, 2, 3] if len(rows) == 3 else [5, 3]
    views = rrb.Vertical(*rows, row_shares=shares)
    return rrb.Blueprint(views, time_panel(), collapse_panels=True)


def view(model, name, x_range, y_range):
    """A view of what a model's balls do in these ranges of x and of -y [m]."""
    bounds = rrb.VisualBounds2D(x_range=x_range, y_range=y_range)
    return rrb.Spatial2DView(origin=f"world/{model}", name=name, visual_bounds=bounds)


def frame(runs, x, large):
    """The ranges of x and of -y [m] that hold all balls of the runs, from first to last.

    A ball that leaves by more than FARTHEST radii is let go, or the others would be dots.
    """
    middle = 0.5 * (float(x.min()) + float(x.max()))
    half = max(reach(run.q[:, 0] - middle, large) for run in runs) + 2.5 * large
    top = max(reach(run.q[:, 1], large) for run in runs) + 2.0 * large
    return [middle - half, middle + half], [-top, 0.12 * top]


def reach(values, large):
    """The largest of the values by size [m], at most FARTHEST radii, also if one is not finite."""
    return float(np.fmin(np.abs(values), FARTHEST * large).max())


def settled_at(runs):
    """When the last ball is slower than 1 cm/s for good [s], and a tenth more; at most the end."""
    ends = [0.0]
    for run in runs.values():
        moving = np.flatnonzero(~(np.abs(run.v) < 0.01).all((1, 2)))
        ends += [run.t[min(len(run.t) - 1, k + k // 10 + 1)] for k in moving[-1:]]
    return float(max(ends))


def plot(title, end):
    """A plot up to `end` [s]. One has the legend, which hides least where impulses are over."""
    name = title.split()[0]
    legend = rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=name == "impulse")
    shown = None
    if 0.0 < end < 9e9:
        first, last = (rrb.TimeRangeBoundary.absolute(seconds=each) for each in (0.0, end))
        shown = rrb.VisibleTimeRange("sim_time", start=first, end=last)
    return rrb.TimeSeriesView(origin=name, name=title, plot_legend=legend, time_ranges=shown)


def time_panel():
    """Opens at t = 0, four times slowed down. rerun-sdk before 0.28 starts there at once."""
    try:
        return rrb.TimePanel(
            timeline="sim_time", play_state="paused", playback_speed=0.25, state="collapsed"
        )
    except TypeError:
        return rrb.TimePanel(timeline="sim_time", state="collapsed", duration_cursor=0.0)
