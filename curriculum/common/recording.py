"""Runs as a rerun recording: balls in a view a run, curves below. Imports rerun when asked.

rerun's 2-D views have y down and no option, so y is negated here and only here.
"""

from curriculum.common.files import whole

PUSH = "#f0e442"  # colour of the arrows
GROUND, LINE = "#3a3f4a", "#ffffff"
WIDTHS = (6.0, 3.6, 2.2, 1.2)  # of curves, in points: lines that coincide are seen beneath
FEW = 24  # balls: more have no arrows
FARTHEST = 150  # radii: how far out of the middle a ball is still kept in view
HIGH = 0.16  # radii: the height of the view that magnifies the table, where a rest sinks by 0.01


def write(path, name, runs, radius, curves, colors, pushes=None, bursts=None):
    """Write a recording, whole, in rerun's strict mode. Raises ImportError where rerun is missing.

    name: application id, [a-z0-9_]. runs {label: run}: run.t (S,) [s] becomes the timelines step
    and sim_time (step alone beyond 9e9 s); run.q (S, 2, N) the balls of `radius` (N,) [m].
    curves {title: {label: values (S,)}}: a plot a title, its path the title's first word.
    colors {label: "#rrggbb"}: one colour a label. pushes {label: (S, 2, N)}: the push on each ball
    as a multiple of its weight, drawn as an arrow. bursts {label: step or None}: when it exploded.
    Whole columns are sent.
    """
    import rerun as rr
    import rerun.blueprint as rrb

    recording = rr.RecordingStream(name)
    rr.set_strict_mode(True)  # a wrong call raises instead of warning
    with whole(path) as temporary:
        recording.save(temporary, default_blueprint=layout(rrb, runs, radius, curves, bursts or {}))
        for label, run in runs.items():
            times = timelines(rr, run.t)
            send_table(rr, recording, label)
            send_balls(rr, recording, label, run, radius, times, colors[label])
            if pushes and len(radius) <= FEW:
                send_pushes(rr, recording, label, run, radius, times, pushes[label])
        widths = WIDTHS[-len(runs) :]
        for place, label in enumerate(sorted(runs)):
            times = timelines(rr, runs[label].t)
            for title, lines in curves.items():
                curve = f"{title.split()[0]}/{label}"
                recording.log(
                    curve,
                    rr.SeriesLines(
                        colors=rgba(colors[label]),
                        names=[label],
                        widths=widths[place % len(widths)],
                        aggregation_policy="MinMax",
                    ),
                    static=True,
                )  # an average hides the peaks
                recording.send_columns(curve, times, rr.Scalars.columns(scalars=lines[label]))
        recording.disconnect()


def rgba(color):
    """The colour "#rrggbb" as rerun stores it."""
    import numpy as np

    return np.array([int(color[1:] + "ff", 16)], np.uint32)


def timelines(rr, t):
    """The columns of time: step, and sim_time where 64 bits of nanoseconds can hold it."""
    import numpy as np

    times = [rr.TimeColumn("step", sequence=np.arange(len(t)))]
    if t[-1] < 9e9:
        nanoseconds = np.round(t * 1e9).astype("timedelta64[ns]")  # whole: no stamp is off
        times.append(rr.TimeColumn("sim_time", duration=nanoseconds))
    return times


def send_table(rr, recording, label):
    """The table: a grey body under the balls, and a thin line over them, so that a sink is seen.

    The body is made of lines of five radii, each with its upper edge at y = 0, since an old viewer
    (0.26) draws a thick line thinner by a hundredth, which left a gap under the thin one.
    """
    wide = 50.0  # m; a longer line is drawn with gaps where it is magnified
    depths = [0.005, 0.05, 0.5, 5.0, 50.0]
    recording.log(
        f"world/{label}/ground",
        rr.LineStrips2D(
            [[[-wide, deep], [wide, deep]] for deep in depths],
            colors=rgba(GROUND),
            radii=depths,
            draw_order=-10.0,
        ),
        static=True,
    )
    recording.log(
        f"world/{label}/table",
        rr.LineStrips2D(
            [[[-wide, 0.0], [wide, 0.0]]],
            colors=rgba(LINE),
            radii=[rr.Radius.ui_points(0.6)],
            draw_order=40.0,
        ),
        static=True,
    )


def send_balls(rr, recording, label, run, radius, times, color):
    """The balls, where the run had them."""
    import numpy as np

    balls = f"world/{label}/balls"
    recording.log(
        balls,
        rr.Points2D.from_fields(
            radii=radius, colors=np.repeat(rgba(color), len(radius)), draw_order=20.0
        ),
        static=True,
    )
    recording.send_columns(
        balls,
        times,
        rr.Points2D.columns(positions=flat(run.q)).partition([len(radius)] * len(run.t)),
    )


def flat(rows):
    """Vectors (S, 2, N) as a list (S N, 2) with y down, in 32 bits, which is what rerun keeps."""
    import numpy as np

    with np.errstate(over="ignore"):
        return np.stack((rows[:, 0], -rows[:, 1]), axis=-1).reshape(-1, 2).astype(np.float32)


def send_pushes(rr, recording, label, run, radius, times, pushes):
    """The push on each ball as an arrow from its centre, r log2(1 + push / weight) long.

    So a ball at rest has an arrow as long as its radius, and an impact still fits in the view.
    """
    import numpy as np

    arrows = f"world/{label}/pushes"
    with np.errstate(all="ignore"):
        size = np.hypot(pushes[:, 0], pushes[:, 1])
        size = np.where((size > 1e-6) & np.isfinite(size), size, np.inf)
        reach = np.where(np.isfinite(size), radius * np.log2(1.0 + size), 0.0)
        vectors = np.where(np.isfinite(size)[:, None], pushes, 0.0) * (reach / size)[:, None]
    recording.log(
        arrows,
        rr.Arrows2D.from_fields(
            colors=np.repeat(rgba(PUSH), len(radius)),
            radii=np.full(len(radius), 0.06) * radius,
            draw_order=30.0,
        ),
        static=True,
    )
    recording.send_columns(
        arrows,
        times,
        rr.Arrows2D.columns(origins=flat(run.q), vectors=flat(vectors)).partition(
            [len(radius)] * len(run.t)
        ),
    )


def layout(rrb, runs, radius, curves, bursts):
    """The blueprint that travels in the file: the balls, the table magnified, the plots, at t = 0.

    Every run has views of its own, so balls that roll far never cross into another run's. Where
    they roll, the views are as wide as the screen, one below the other; where they stand above one
    another, the table is magnified under them.
    """
    first = next(iter(runs.values()))
    large = float(radius.max())
    sound = [run for label, run in runs.items() if bursts.get(label) is None]
    x_range, y_range = frame(sound or [first], large)
    lanes = [
        rrb.Spatial2DView(
            origin=f"world/{label}",
            name=told(label, bursts.get(label)),
            visual_bounds=rrb.VisualBounds2D(x_range=x_range, y_range=y_range),
        )
        for label in runs
    ]
    wide = x_range[1] - x_range[0] > 1.2 * (y_range[1] - y_range[0])
    rows = [rrb.Vertical(*lanes) if wide else rrb.Horizontal(*lanes)]
    start = first.q[0, 0]
    if float(start.max() - start.min()) < large and not wide:
        rows.append(rrb.Horizontal(*[magnified(rrb, label, start[0], large) for label in runs]))
    rows.append(rrb.Horizontal(*plots(rrb, curves)))
    shares = [5, 2, 3] if len(rows) == 3 else [5, 3]
    return rrb.Blueprint(
        rrb.Vertical(*rows, row_shares=shares), time_panel(rrb), collapse_panels=True
    )


def frame(runs, large):
    """The ranges of x and of -y [m] that hold all balls of these runs, from first to last.

    A ball that leaves by more than FARTHEST radii is let go, or the others would be dots.
    """
    x = runs[0].q[0, 0]
    middle = 0.5 * (float(x.min()) + float(x.max()))
    half = max(reach(run.q[:, 0] - middle, large) for run in runs) + 2.5 * large
    top = max(reach(run.q[:, 1], large) for run in runs) + 2.0 * large
    return [middle - half, middle + half], [-top, 0.12 * top]


def reach(values, large):
    """The largest of the values by size [m], at most FARTHEST radii."""
    import numpy as np

    far = np.abs(values).max()
    return float(min(far, FARTHEST * large)) if np.isfinite(far) else FARTHEST * large


def magnified(rrb, label, x, large):
    """A view of the place where the balls stand on the table, HIGH radii high."""
    high = HIGH * large
    bounds = rrb.VisualBounds2D(
        x_range=[x - 1.2 * high, x + 1.2 * high], y_range=[-0.4 * high, 0.6 * high]
    )
    name = f"the table, magnified: {HIGH:g} r high"
    return rrb.Spatial2DView(origin=f"world/{label}", name=name, visual_bounds=bounds)


def plots(rrb, curves):
    """A plot a title. One of them has the legend, since a legend hides the curves under it."""
    emptiest = min(curves, key=lambda title: crowd(curves[title]))
    return [
        rrb.TimeSeriesView(
            origin=title.split()[0],
            name=title,
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=title == emptiest),
        )
        for title in curves
    ]


def crowd(lines):
    """How high the lines {label: values} come in their last half, as a share of their range."""
    import numpy as np

    values = np.array([np.where(np.isfinite(line), line, 0.0) for line in lines.values()])
    with np.errstate(over="ignore"):
        height = float(np.ptp(values))
    late = float(values[:, values.shape[1] // 2 :].max() - values.min())
    return late / height if 0.0 < height < np.inf else 1.0


def told(label, burst):
    """The name of a view: the model, and whether it exploded."""
    return label if burst is None else f"{label}: EXPLODED at step {burst}"


def time_panel(rrb):
    """Opens at t = 0. rerun-sdk before 0.28 cannot be told to wait there; it starts at once."""
    try:
        return rrb.TimePanel(timeline="sim_time", play_state="paused", state="collapsed")
    except TypeError:
        return rrb.TimePanel(timeline="sim_time", state="collapsed", duration_cursor=0.0)
