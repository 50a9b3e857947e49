"""Write runs as a rerun recording: a view of balls for every model, curves beside them.

rerun's 2-D views have y down and no option, so y is negated here and nowhere else.
Raises contact.MissingPackage on import where rerun is missing.
"""

import numpy as np

import contact
from curriculum import commands
from curriculum.show.picture import COLORS, contact_impulses, curves, weight, worth_seeing

try:
    import rerun as rr
    import rerun.blueprint as rrb
except ImportError:
    raise contact.MissingPackage(commands.to_install("rerun-sdk")) from None

PUSH = "#f0e442"  # colour of the arrows
FIXED, LINE = "#3a3f4a", "#808080"  # colours of fixed balls and of the table, by day and night
WIDE = 50.0  # m: half the table; a longer line is drawn with gaps where it is magnified
MOST_ARROWS = 24  # balls: more have no arrows
SECONDS = ("sim_time", "landing")  # timelines, besides step
LONGEST = 9e9  # s: 64 bits of nanoseconds
MAGNIFIED = 0.16  # radii: the height of the view of the table, where a rest sinks by 0.01
ABOUT = """\
**{title}**

An arrow is what all contacts push on a ball: a radius for its weight, and a radius more for each
doubling. Below, the table is magnified: those views are so many r high.
The line `landing` begins at the first contact, at {first:.4g} s; `sim_time` at the start.
"""


def write(path: str, runs: dict, scene: contact.Scene, quality: dict, title: str) -> None:
    """Write the runs {model: Run} of a scene as a recording, whole or not at all.

    quality: {model: contact_quality} of the runs. Whole columns are sent, in rerun's strict mode.
    The timelines are step, sim_time, and landing, which it opens on: sim_time, but all that is
    before the first push at its start. The entities are about, world/MODEL/{table,balls,pushes,
    foot} and CURVE/MODEL; foot only where one ball moves, on a fixed one.
    """
    rr.set_strict_mode(True)  # a wrong call raises instead of warning
    drawn, seconds = curves(runs, scene), worth_seeing(runs, scene)
    times = {model: timelines(run.t, seconds[0]) for model, run in runs.items()}
    recording = rr.RecordingStream("contact")
    if not rr.is_enabled(recording):
        raise contact.MissingPackage("rerun is switched off by the variable RERUN")
    # rerun's own file would wait for ever where a disk is full
    kept = recording.binary_stream()  # type: ignore[misc]
    blueprint = layout(runs, scene, drawn, seconds, quality)
    recording.send_blueprint(blueprint, make_active=True, make_default=True)
    words = ABOUT.format(title=title, first=seconds[0])
    recording.log("about", rr.TextDocument(words, media_type=rr.MediaType.MARKDOWN), static=True)
    for model, run in runs.items():
        send_table(recording, model)
        send_balls(recording, model, run, scene, times[model])
    send_curves(recording, runs, drawn, times)
    commands.write_atomic(path, kept.read())


def rgba(color: str) -> np.ndarray:
    """Return the colour "#rrggbb" as rerun stores it."""
    return np.array([int(color[1:] + "ff", 16)], np.uint32)


def timelines(t: np.ndarray, first: float) -> list:
    """Return the columns of time."""
    times = [rr.TimeColumn("step", sequence=np.arange(len(t)))]
    for name, seconds in zip(SECONDS, (t, np.maximum(t, first))):
        nanoseconds = np.round(np.minimum(seconds, LONGEST) * 1e9)  # no stamp is off
        times.append(rr.TimeColumn(name, duration=nanoseconds.astype("timedelta64[ns]")))
    return times


def send_table(recording, model):
    """Send the table: a thin line over the balls, which shows how far one sinks."""
    ends = [[-WIDE, 0.0], [WIDE, 0.0]]
    look = {"colors": rgba(LINE), "radii": rr.Radius.ui_points(0.6), "draw_order": 40.0}
    recording.log(f"world/{model}/table", rr.LineStrips2D([ends], **look), static=True)


def send_balls(recording, model, run, scene, times):
    """Send the balls, where the run had them, and the push on each as an arrow from its centre."""
    count, rows = len(scene.radius), [len(scene.radius)] * len(run.t)
    color = np.where(np.isfinite(scene.mass), rgba(COLORS[model]), rgba(FIXED))
    look = rr.Points2D.from_fields(radii=scene.radius, colors=color, draw_order=20.0)
    columns = rr.Points2D.columns(positions=flat(run.q)).partition(rows)
    send(recording, f"world/{model}/balls", look, times, columns)
    if (foot := foot_of(run, scene)) is not None:
        place = np.stack((foot[:, 0], -foot[:, 1], 0.0 * run.t), axis=-1)
        columns = rr.Transform3D.columns(translation=place)
        recording.send_columns(f"world/{model}/foot", times, columns)
    if count > MOST_ARROWS:
        return
    color = np.repeat(rgba(PUSH), count)
    look = rr.Arrows2D.from_fields(radii=0.06 * scene.radius, colors=color, draw_order=30.0)
    arrows = rr.Arrows2D.columns(origins=flat(run.q), vectors=flat(arrow_vectors(run, scene)))
    send(recording, f"world/{model}/pushes", look, times, arrows.partition(rows))


@np.errstate(all="ignore")
def foot_of(run: contact.Run, scene: contact.Scene) -> np.ndarray | None:
    """Return where a ball touches the fixed one (S, 2) [m], to be followed, in a scene of two."""
    if len(scene.mass) != 2 or np.isfinite(scene.mass).all():
        return None
    ball = int(np.isfinite(scene.mass).argmax())
    way = run.q[..., 1 - ball] - run.q[..., ball]
    unit = way / np.hypot(*way.T)[:, None]
    return np.nan_to_num(run.q[..., ball] + scene.radius[ball] * unit)


def send(recording, entity: str, look, times, columns) -> None:
    """Send an entity: its look, once, and what changes of it, a row a step."""
    recording.log(entity, look, static=True)
    recording.send_columns(entity, times, columns)


def flat(rows: np.ndarray) -> np.ndarray:
    """Return vectors (S, 2, N) as a list (S N, 2) with y down, in the 32 bits that rerun keeps."""
    with np.errstate(over="ignore"):
        return np.stack((rows[:, 0], -rows[:, 1]), axis=-1).reshape(-1, 2).astype(np.float32)


@np.errstate(all="ignore")
def arrow_vectors(run: contact.Run, scene: contact.Scene) -> np.ndarray:
    """Return arrows (S, 2, N) along the pushes, r log2(1 + push / weight) long [m].

    So a ball at rest has an arrow as long as its radius, and an impact still fits in the view.
    """
    weight = -contact.GRAVITY * scene.mass * np.diff(run.t[:2]).sum()
    pushes = contact_impulses(run, scene) / weight
    size = np.hypot(pushes[:, 0], pushes[:, 1])
    drawn = (size > 1e-6) & np.isfinite(size)
    length = scene.radius * np.log2(1.0 + size)
    return np.where(drawn[:, None], pushes * (length / size)[:, None], 0.0)


def send_curves(recording, runs: dict, drawn: dict, times: dict) -> None:
    """Send the curves {title: {model: values}}, each at the title's first word / MODEL."""
    for place, model in enumerate(sorted(runs, reverse=True)):
        width = 1.2 * 1.5**place  # points: lines that coincide are seen beneath
        line = {"colors": rgba(COLORS[model]), "names": model, "widths": width}
        look = rr.SeriesLines(**line, aggregation_policy="MinMax")  # an average hides the peaks
        for title, lines in drawn.items():
            columns = rr.Scalars.columns(scalars=lines[model])
            send(recording, f"{title.split()[0]}/{model}", look, times[model], columns)


def layout(runs, scene, drawn, seconds: tuple, quality: dict) -> rrb.Blueprint:
    """Return the blueprint that travels in the file: on the left the balls, and under them the
    table magnified; on the right what it is, and the plots.

    Every run has views of its own, so balls that roll far never cross into another run's. Where
    one ball moves on a fixed one, they go with its foot.
    """
    free = np.isfinite(scene.mass)
    large, (x, y) = float(scene.radius[free].max()), scene.q0[:, free]
    followed = foot_of(next(iter(runs.values())), scene) is not None
    if followed:
        x, y = np.zeros(1), np.full(1, 5.0 * large)
    middle, wide = 0.5 * (x.min() + x.max()), 0.8 * np.ptp(x) + 1.6 * large
    top = y.max() + 2.0 * large
    sides = [middle - wide, middle + wide], [-top, (0.3 if followed else 0.1) * top]
    high = MAGNIFIED if np.ptp(x) == 0.0 else 3.0  # radii; of a pile it shows the middle
    reach = high * large
    near = [middle - 1.2 * reach, middle + 1.2 * reach], [-0.6 * reach, 0.4 * reach]
    ends = {model: f"{model}: {contact.final_state(quality[model])}" for model in runs}
    lanes = rrb.Grid(*[view(model, ends[model], *sides, followed) for model in runs])
    small = rrb.Horizontal(*[view(model, f"{high:g} r", *near, followed) for model in runs])
    about = rrb.TextDocumentView(origin="about", name="about")
    most = 5.0 * weight(scene)
    right = rrb.Vertical(about, *[plot(title, most, *seconds) for title in drawn])
    left = rrb.Vertical(lanes, small, row_shares=[5, 2])
    both = rrb.Horizontal(left, right, column_shares=[3, 2])
    return rrb.Blueprint(both, time_panel(), collapse_panels=True)


def view(model: str, name: str, x_range: list, y_range: list, followed) -> rrb.Spatial2DView:
    """Return a view of a model's balls in these ranges of x and of -y [m], from its foot."""
    world = f"world/{model}"
    origin = f"{world}/foot" if followed else world
    bounds = rrb.VisualBounds2D(x_range=x_range, y_range=y_range)
    return rrb.Spatial2DView(origin=origin, contents=f"{world}/**", name=name, visual_bounds=bounds)


def plot(title: str, most: float, first: float, last: float) -> rrb.TimeSeriesView:
    """Return a plot of times [s] after `first`, in the balls' colours; of a force up to `most`."""
    name, shown = title.split()[0], None
    axis = rrb.ScalarAxis(range=(0.0, most)) if name == "force" else None
    if first < last < LONGEST:  # all that was before stands on the first instant: left out
        start, end = (rrb.TimeRangeBoundary.absolute(seconds=each) for each in (first + 1e-6, last))
        shown = [rrb.VisibleTimeRange(line, start=start, end=end) for line in SECONDS]
    how = {"plot_legend": rrb.PlotLegend(visible=False), "time_ranges": shown, "axis_y": axis}
    return rrb.TimeSeriesView(origin=name, name=title, **how)  # type: ignore[arg-type]


def time_panel():
    """Open on the landing, four times slowed down; rerun-sdk before 0.28 plays it at once."""
    try:
        return rrb.TimePanel(timeline="landing", play_state="paused", playback_speed=0.25)
    except TypeError:
        return rrb.TimePanel(timeline="landing")
