"""The exact model: from event to event, with no time step (robotics course, chapter 3.5).

Balls over the line y = 0, frictionless. Between two events the set of pushing contacts stays the
same, and the motion is smooth. Where no ball slides along another it is a parabola in time; where
one does, the pushing contacts are equations, gap = 0, and the motion is a Taylor series in time.
An event is a gap that closes, a force that falls to zero, or a series that comes to its end. It
concerns the balls that touch one another there, an island; all other balls go on as they were, and
so do those of the island that rest and stay at rest.

    Island     finds the balls, and all contacts that they can make,
    separate   closes what rounding has left of overlaps,
    touching   picks the contacts that touch,
    collide    gives impulses to the contacts that close: an LCP of velocities,
    support    gives forces to the contacts that rest: an LCP of accelerations,
    expand     gives the motion under these forces: a parabola, or a series where balls slide,
    predict    finds when each contact that does not push will close.

What comes first is at the top of a heap. Among many balls each looks only at those near its home,
the place where it was when it last looked about. When it may have left, that is an event, too.
Samples are read from the series, so when they are taken does not enter the motion.

A light ball between two heavy ones may be struck a thousand times while gaps shrink to 1e-40 m and
open again, and where it goes then hangs on all of them. So times are whole numbers of a tiny unit,
which sums do not round, and a small gap is followed by a series of its own, with all its digits.

    symbol   meaning                                          unit
    q, v, a  positions, velocities, accelerations             m, m/s, m/s^2: {body: (x, y)}
    w        1 / mass; 0 for the floor and for a fixed ball   1/kg
    i, j     the bodies of a contact; the floor is always j
    n        unit normal of a contact, from j to i
    gap      distance of the surfaces; depth = -gap           m
    v_n      n . (v_i - v_j), > 0 separating                  m/s
    lam      impulse or force of a contact, >= 0              N s or N
    J, M     J v is v_n of every contact, M the masses, so W = J M^-1 J' (Delassus)
    s        in an LCP, s = W lam + b >= 0: the normal speed or acceleration that is left

Why every loop ends. The pivot (solve_lcp), the separation of overlaps and the search for a root
(first_fall) count their steps and stop. Events have no such bound of their own, since bounces can
follow one another ever faster. A bounce that rises less than LAST radii is the last of its series,
and so is one of a contact that opened less than THIN radii since the bounce before: a light ball
between a heavy one and the floor is struck infinitely often in finite time, and the limit is rest.
A velocity below 1e-13 of what was added up to it counts as round-off, and is set to 0 (react).
The clock ends what is left: after EVENTS events per ball (and 20 times EVENTS at least) within a
tick of motion, it moves on by a hundredth of a tick at least, with at most one event per ball each
time, until the tick is over. That is a limit of run time: what closes in the meantime overlaps, and
is moved apart when its turn comes.
"""

# --- region: exact-setup ---
import heapq
import math
from bisect import bisect_right
from functools import cached_property
from itertools import zip_longest

import numpy as np

ORDER = 14      # of the Taylor series in time
LONGER = 64     # a series need not last more than so many times as long as the quiet before it
TOUCH = 1e-12   # of a radius: a smaller gap is none
LAST = 1e-13    # of a radius: a bounce that rises less is the last of its series
NOISE = 1e-13   # of sqrt(g r): a smaller speed is round-off
CUT = 7e-15     # of sqrt(g r): a series lasts while its last two terms move a ball more slowly
GRAZE = 1e-12   # of g: a contact that pushes its bodies apart with less does not push
FOLLOWED = 1e-8 # of a radius: a smaller gap is followed by its own series
THIN = 1e-40    # of a radius: a contact that opened less and closes does not bounce
SECOND = 2**300 # of the unit of time
EVENTS = 10000  # per ball and tick, and of 20 balls at least, before the clock waits
TICK = 0.1      # of sqrt(r / g), r the smallest radius
FEW = 12        # balls: among so few, each looks at all the others
ROOM = 0.5      # of a radius: among more than FEW, a ball this far from home looks again
# --- endregion ---


# --- region: exact-time ---
def later(time, span):
    """The time `span` [s] after another, in units of 1 / SECOND, not rounded; inf is never."""
    return time + int(span * SECOND) if span < math.inf else math.inf


def seconds(start, time):
    """How long [s] from one time to another, rounded once."""
    return (time - start) / SECOND
# --- endregion ---


# --- region: exact-body ---
class Body:
    """A ball, or the floor, and its motion until its next event.

    x and y [m] are series in the time since start [s]: 3 numbers for a parabola, 7 or more else.
    """

    def __init__(self, w, radius, q, v):
        self.bodies = (self,)                   # whom an event of it concerns
        self.w, self.radius = w, radius         # 1 / mass [1/kg] and [m]
        self.x, self.y = [q[0], v[0], 0.0], [q[1], v[1], 0.0]
        self.start, self.due = 0, math.inf      # the series holds between these times
        self.near = {}                          # {body: Contact} of all it can meet until then
        self.home, self.room = q, 0.0           # until then it stays within room [m] of home
        self.path, self.done = [], 0            # (samples, start, x, y) of the past; their sum

    def at(self, time):
        """Position and velocity (x, y) at a time."""
        s = seconds(self.start, time)
        q = evaluate(self.x, s), evaluate(self.y, s)
        return q, (evaluate(rate(self.x), s), evaluate(rate(self.y), s))

    def remember(self, samples):
        """Keep the series for those of the first `samples` samples that no earlier one gives."""
        if samples > self.done:
            self.path.append((samples - self.done, self.start, self.x, self.y))
            self.done = samples

    def rests(self, x, y):
        """Whether these series are rest, where the ball rests already."""
        return self.x == x and self.y == y and not any(x[1:] + y[1:])

    def read(self, times):
        """x and y, and their rates (S,), at the times (S,) from the series that were kept."""
        counts, starts, *series = zip(*self.path)
        s = times - np.repeat([seconds(0, start) for start in starts], counts)
        out = []
        for rows in series:
            rows = np.array([*zip_longest(*rows, fillvalue=0.0)])       # (orders, series)
            slopes = np.arange(1.0, len(rows))[:, None] * rows[1:]
            out.append([evaluate(np.repeat(p, counts, 1), s) for p in (rows, slopes)])
        return out
# --- endregion ---


# --- region: exact-pair ---
class Pair:
    """Two bodies that can touch, and how they lie; the floor is always the second."""

    def __init__(self, i, j):
        self.i, self.j, self.wall = i, j, j.radius == 0.0       # the floor is flat
        self.bodies = (i, j)                    # whom an event of it concerns
        self.reach = i.radius + j.radius        # distance of the centres in touch [m]
        self.nx, self.ny, self.depth = 0.0, 1.0, 0.0    # n from j to i; depth = -gap [m]
        self.small = 0.0                        # a gap that is none [m]

    def locate(self, q):
        """Take normal and depth from the positions q {body: (x, y)}, and what counts as a gap."""
        (xi, yi), (xj, yj) = q[self.i], q[self.j]
        dx, dy = (0.0 if self.wall else xi - xj), yi - yj
        distance = dy if self.wall else math.sqrt(dx * dx + dy * dy)
        self.depth = self.reach - distance
        self.nx, self.ny = 0.0, 1.0             # two balls with one centre: some normal is needed
        if dx != 0.0 or dy < 0.0:
            self.nx, self.ny = dx / distance, dy / distance
        bits = 4.0 * math.ulp(max(abs(xi), abs(yi), abs(xj), abs(yj)))
        self.small = bits + TOUCH * self.i.radius

    def along(self, rows):
        """n . (rows_i - rows_j): with v, the normal velocity v_n."""
        (xi, yi), (xj, yj) = rows[self.i], rows[self.j]
        return self.nx * (xi - xj) + self.ny * (yi - yj)

    def across(self, rows):
        """The tangent's part of rows_i - rows_j; 0 at the floor, whose normal never turns."""
        (xi, yi), (xj, yj) = rows[self.i], rows[self.j]
        return 0.0 if self.wall else self.nx * (yi - yj) - self.ny * (xi - xj)

    def turning(self, v):
        """What the turning of the normal adds to the second derivative of the gap [m/s^2]."""
        slip = self.across(v)
        return slip * slip / self.reach
# --- endregion ---


# --- region: exact-contact ---
class Contact(Pair):
    """A pair, what happened to it and what will."""

    def __init__(self, i, j, gravity):
        super().__init__(i, j)
        self.speed = math.sqrt(-gravity * i.radius)     # a fall of half a radius gives it [m/s]
        self.due = math.inf                     # when it closes, or stops pushing
        self.rests = self.pushes = False        # it did not part when it touched; it pushes
        self.last_touch = -math.inf             # when it touched last
        self.parting = 0.0                      # |v_n| it parted with then [m/s]
        self.thin = -math.inf                   # when it closed, hardly opened
        self.series, self.since = None, 0       # of its gap, and the time it starts from
        self.path = None                        # what gap_series makes it from: gap, dx, dy

    def look(self, q, now):
        """Locate it; a small gap is then read from its own series, with all its digits.

        A pair's series is distance^2 - reach^2, so it is divided by distance + reach.
        """
        self.locate(q)
        if (self.series or self.path) and abs(self.depth) < FOLLOWED * self.i.radius:
            self.series = self.series or gap_series(self, *self.path)
            value = evaluate(self.series, seconds(self.since, now))
            if not self.wall:
                value /= self.reach + math.sqrt(self.reach * self.reach + value)
            self.depth = -value

    def follow(self, now, dx, dy):
        """Follow the gap from now on, by the series of the positions' difference."""
        self.series, self.since = None, now
        self.path = max(-self.depth, 0.0), dx, dy

    def opened(self, now, v_n):
        """An estimate [m] of how far it was open since it touched last."""
        return (self.parting + abs(v_n)) * seconds(self.last_touch, now)

    def closes(self, v_n):
        """Whether the bodies approach, by more than round-off."""
        return v_n < -NOISE * self.speed

    def parts(self, v_n):
        """Whether the bodies part, by more than round-off."""
        return v_n > NOISE * self.speed

    def is_slow(self, v_n):
        """Whether a bounce with this speed rises less than LAST radii."""
        return abs(v_n) < math.sqrt(2.0 * LAST) * self.speed

    def touched(self, now, v_n):
        """Note when it touched and how fast it parts; inf if it closes: never "hardly opened"."""
        self.last_touch, self.parting = now, math.inf if self.closes(v_n) else abs(v_n)
        if self.rests:
            self.series = [0.0]                 # no gap, whatever the last digits of q say
# --- endregion ---


# --- region: exact-pivot ---
class Table:
    """s = W lam + b, solved for lam of the active contacts and for s of the others.

    rows (K, K + 1): column K is what the left-hand sides are while the right-hand ones are 0.
    """

    def __init__(self, problem, wanted):
        """Activate those of `wanted`, largest diagonal first, but none that depends on others."""
        self.rows, self.active, left = problem.copy(), np.zeros(len(problem), bool), wanted.copy()
        while (diagonal := self.rows[:, :-1].diagonal() * left).max() > 1e-12:
            left[k := diagonal.argmax()] = False
            self.exchange(k)

    def exchange(self, k):
        """Let lam_k and s_k change sides."""
        rows = self.rows
        row, column, pivot = rows[k] / -rows[k, k], rows[:, k].copy(), rows[k, k]
        rows += column[:, None] * row
        rows[:, k], rows[k], rows[k, k] = column / pivot, row, 1.0 / pivot
        self.active[k] = ~self.active[k]

    def step(self, lam, least):
        """Exchange one contact or two: the next lam, and whether it is the answer (no exchange)."""
        trial = np.where(self.active, self.rows[:, -1], 0.0)
        bad = np.flatnonzero(trial < least)
        if len(bad):                            # towards trial until the first would pull
            share = lam[bad] / (lam[bad] - trial[bad])
            lam = np.where(self.active, lam + share.min() * (trial - lam), 0.0)
            self.exchange(bad[share.argmin()])
            return lam, False
        s = np.where(self.active, 0.0, self.rows[:, -1])
        k = s.argmin()                          # closes fastest: it is to push
        if s[k] >= least:
            return trial, True
        if self.rows[k, k] < 1e-12:             # it depends on others: one of those stops
            column = np.where(self.active, self.rows[:, k], 0.0)
            fall = np.flatnonzero(column < -1e-9)
            if not len(fall):
                return trial, True              # s_k < 0 is round-off
            share = trial[fall] / -column[fall]
            trial = trial + share.min() * column
            trial[k] = share.min()
            self.exchange(fall[share.argmin()])
        self.exchange(k)
        return trial, False
# --- endregion ---


# --- region: exact-lcp ---
def solve_lcp(W, b):
    """lam (K,) >= 0 with s = W lam + b >= 0 and lam s = 0; W (K, K) the Delassus matrix, b (K,).

    Pivoting after Lawson and Hanson (1974), from all contacts active, as at rest. Contacts stop
    until none would pull. Each time that is reached, lam'W lam / 2 + b'lam is lower than the last
    time, so no such active set comes twice. Rounding can break that, so exchanges are counted; and
    the table is made afresh until it needs no more, at most nine times.
    """
    if len(b) < 2:
        return np.maximum(-b / W.diagonal(), 0.0)
    scale = np.ldexp(1.0, -np.frexp(W.diagonal())[1] // 2)  # diagonal near 1: one tolerance for all
    problem = np.column_stack((W * scale * scale[:, None], b * scale))
    least = -1e-13 * np.abs(problem[:, -1]).max()
    active, lam = scale > 0.0, np.zeros(len(b))
    for _ in range(9):
        table = Table(problem, active)
        for exchanges in range(50 + 10 * len(b)):
            lam, done = table.step(lam, least)
            if done:
                break
        active = table.active
        if exchanges == 0 or not done:
            break
    return np.maximum(lam, 0.0) * scale
# --- endregion ---


# --- region: exact-matrix ---
def coupled(contacts):
    """K rows {m: how far a unit impulse at contact m changes v_n at this one} of J M^-1 J'."""
    rows, of_body = [{} for _ in contacts], {}
    for k, contact in enumerate(contacts):
        of_body.setdefault(contact.i, []).append((k, 1.0, contact))
        of_body.setdefault(contact.j, []).append((k, -1.0, contact))
    for body, mine in of_body.items():
        if body.w > 0.0:
            for k, sign, a in mine:
                for m, other, b in mine:
                    change = sign * other * body.w * (a.nx * b.nx + a.ny * b.ny)
                    rows[k][m] = rows[k].get(m, 0.0) + change
    return rows


def eliminated(rows, b):
    """x [K] with W x = b, for a positive definite W of K rows {column: entry that is not 0}.

    Gauss's elimination; it is short where few contacts share a body. None where W is singular.
    """
    left, x = [dict(row) for row in rows], list(b)
    for k, row in enumerate(left):
        if not row[k] > 1e-12 * rows[k][k]:
            return None
        below = [m for m in row if m > k]
        for m in below:
            share = row[m] / row[k]
            x[m] -= share * x[k]
            for n in below:
                left[m][n] = left[m].get(n, 0.0) - share * row[n]
    for k in reversed(range(len(x))):
        for m, entry in left[k].items():
            if m > k:
                x[k] -= entry * x[m]
        x[k] /= left[k][k]
    return x


def inverted(W):
    """The inverse of a positive definite W. Blocks that do not act on each other stay apart."""
    W = W.copy()
    for k in range(len(W)):
        row, column, pivot = W[k] / -W[k, k], W[:, k].copy(), W[k, k]
        W += column[:, None] * row
        W[:, k], W[k], W[k, k] = column / pivot, row, 1.0 / pivot
    return W


def applied(matrix, b):
    """matrix b, summed by numpy itself: `@` adds up in another order on another machine."""
    return (matrix * b).sum(1)
# --- endregion ---


# --- region: exact-group ---
class Group(list):
    """Contacts that act together. `rows` are of the bodies: {body: (x, y)}."""

    @cached_property
    def couplings(self):
        """J M^-1 J' by its K rows, without those of contacts that share no ball."""
        return coupled(self)

    @cached_property
    def delassus(self):
        """The same as a matrix W (K, K)."""
        W = np.zeros((len(self), len(self)))
        for k, row in enumerate(self.couplings):
            W[k, list(row)] = list(row.values())
        return W

    @cached_property
    def inverse(self):
        """The inverse of J M^-1 J' (K, K), for contacts of which none depends on others."""
        return inverted(self.delassus)

    def along(self, rows):
        """n . (rows_i - rows_j), a list of K: with v, the normal velocities v_n."""
        return [contact.along(rows) for contact in self]

    def push(self, lam, rows):
        """Add M^-1 J' lam to the rows. Returns how much was added up for each body."""
        size = {}
        for contact, impulse in zip(self, lam):
            for body, share in ((contact.i, impulse), (contact.j, -impulse)):
                share *= body.w
                if share != 0.0:
                    x, y = rows[body]
                    size[body] = size.get(body, max(abs(x), abs(y))) + abs(share)
                    rows[body] = (x + share * contact.nx, y + share * contact.ny)
        return size

    def solve(self, b):
        """lam [K] of the LCP s = W lam + b.

        Often all contacts push, as in a tower: then W lam = -b, and there is nothing to pivot.
        """
        lam = eliminated(self.couplings, [-part for part in b])
        return lam if lam and min(lam) >= 0.0 else solve_lcp(self.delassus, np.array(b)).tolist()

    def react(self, rows, b):
        """Solve the LCP s = W lam + b and add its pushes to the rows: n . rows grows by W lam.

        What is left of a row at round-off, below 1e-13 of what was added up, is set to zero.
        """
        lam = self.solve(b)
        for body, size in self.push(lam, rows).items():
            rows[body] = tuple(part if abs(part) > 1e-13 * size else 0.0 for part in rows[body])
        return lam

    def correct(self, rows, error):
        """Make the one set of pushes that takes `error` [K] from n . rows."""
        if any(error):
            self.push(applied(self.inverse, -np.array(error)).tolist(), rows)
# --- endregion ---


# --- region: exact-island ---
class Island:
    """The balls that touch one another at the time `now`, one by one or through others.

    What nothing moves, as the floor, passes nothing on and belongs to no island.
    """

    def __init__(self, now, woken):
        self.now = now
        self.q, self.v = {}, {}                 # {body: (x, y)}, of its neighbours too
        self.balls = {}                         # in the order in which they were found
        self.contacts = {}                      # all that its balls can make
        self.add([woken])

    def add(self, left):
        """Take in these balls, and what hangs together with them."""
        while left:
            ball = left.pop()
            if ball not in self.balls:
                self.balls[ball] = True
                left += self.neighbours(ball)

    def neighbours(self, ball):
        """The balls that touch this one. Notes where it and its neighbours are."""
        found = []
        self.place(ball)
        for other, contact in ball.near.items():
            if contact not in self.contacts:    # else it was found from the other side
                self.place(other)
                contact.look(self.q, self.now)
                self.contacts[contact] = True
                if other.w > 0.0 and (contact.depth >= -contact.small or self.is_due(contact)):
                    found.append(other)
        return found

    def place(self, body):
        """Note position and velocity of a body."""
        if body not in self.q:
            self.q[body], self.v[body] = body.at(self.now)

    def quiet(self):
        """How long [s] nothing has happened to its balls."""
        return min(seconds(ball.start, self.now) for ball in self.balls)

    def is_due(self, contact):
        """Whether an event of this contact is to be settled now."""
        return contact.due <= self.now
# --- endregion ---


# --- region: exact-touch ---
def separate(island):
    """Move the balls until no overlap is left that is more than `small`.

    Overlaps close as velocities do in an impact: by pushes, so that heavy balls move less. The LCP
    includes every gap up to twice the deepest overlap, so that few pushes make an overlap of one;
    what they do make is for the next round, of 50 at most.
    """
    for _ in range(50):
        if not any(contact.depth > contact.small for contact in island.contacts):
            break
        least = -2.0 * max(contact.depth for contact in island.contacts)
        closing = Group(contact for contact in island.contacts if contact.depth >= least)
        island.add([body for contact in closing for body in contact.bodies if body.w > 0.0])
        closing.react(island.q, [-contact.depth for contact in closing])
        for contact in island.contacts:
            contact.series = contact.path = None
            contact.locate(island.q)


def touching(island):
    """The Group of contacts that touch: at rest, due, or with a gap that is none.

    What rested and does not push may have let go: once it parts it is open, however little. Where a
    contact has hardly been wider open since it touched last, as under a light ball that rattles
    between two others, only a gap below a ten thousandth of that touches.
    """
    found = Group()
    for contact in island.contacts:
        if contact.depth >= -contact.small or island.is_due(contact):
            v_n = contact.along(island.v)
            tie = min(contact.small, 1e-4 * contact.opened(island.now, v_n))
            at_rest = contact.pushes or contact.rests and not contact.parts(v_n)
            if at_rest or island.is_due(contact) or -contact.depth <= tie:
                found.append(contact)
    return found


def hardly_opened(island, contacts, v_n):
    """For each of the contacts whether it closes although it has opened less than THIN radii.

    Bounces so small come from a cascade that is infinite: the limit is rest. Once it has stopped at
    one contact, it stops at all that were open just then, if by less than ten thousand times that.
    """
    last, found = max(contact.thin for contact in contacts), []
    for contact, speed in zip(contacts, v_n):
        widest = (1e4 if last > contact.last_touch else 1.0) * THIN * contact.i.radius
        thin = contact.closes(speed) and contact.opened(island.now, speed) < widest
        found.append(thin)
        if thin:
            contact.thin = island.now
    return found
# --- endregion ---


# --- region: exact-collide ---
def collide(island, contacts, restitution):
    """Give impulses to the contacts that close: v_n becomes -e v_n where they push.

    One that is due and approaches is struck, be it as slowly as round-off. Those that have hardly
    opened, or would bounce slowly, get v_n = 0: their series ends.
    """
    v_n = contacts.along(island.v)
    if not any(contact.closes(speed) or speed < 0.0 and island.is_due(contact)
               for contact, speed in zip(contacts, v_n)):
        return
    bounce = []
    for contact, speed, thin in zip(contacts, v_n, hardly_opened(island, contacts, v_n)):
        back = -restitution * speed
        ends = thin or 0.0 < back and contact.is_slow(back)
        bounce.append(0.0 if ends else back)    # never above -e v_n, so that no energy is gained
    lam = contacts.react(island.v, [speed - back for speed, back in zip(v_n, bounce)])
    struck = Group(contact for contact, push in zip(contacts, lam) if push > 0.0)
    bounce = [back for back, push in zip(bounce, lam) if push > 0.0]
    for _ in range(3):                          # unequal masses: once more, for the last digits
        error = [speed - back for speed, back in zip(struck.along(island.v), bounce)]
        if not any(abs(e) > NOISE * contact.speed for e, contact in zip(error, struck)):
            break
        struck.correct(island.v, error)
# --- endregion ---


# --- region: exact-support ---
def support(island, contacts, gravity):
    """Give forces to the contacts that rest: the Group of those that push, and the accelerations.

    A resting contact may open but not close: the second derivative of its gap, n . a + slip^2 over
    the distance of the centres, is at least 0. Each contact notes whether it rests and pushes.
    """
    a = {body: (0.0, gravity if body.w > 0.0 else 0.0) for body in island.q}
    for contact in contacts:
        contact.rests = contact.is_slow(contact.along(island.v))
    resting = Group(contact for contact in contacts if contact.rests)
    if not resting:
        return resting, a
    lam = resting.react(a, normal_accelerations(resting, island.v, a))
    for contact, force in zip(resting, lam):
        contact.pushes = force * (contact.i.w + contact.j.w) > -GRAZE * gravity
    held = Group(contact for contact in resting if contact.pushes)
    held.correct(island.v, held.along(island.v))    # round-off, or the last of a series of bounces
    held.correct(a, normal_accelerations(held, island.v, a))
    return held, a


def normal_accelerations(contacts, v, a):
    """The second derivative of each gap [m/s^2]: n . a, and what the turning normal adds."""
    return [contact.along(a) + contact.turning(v) for contact in contacts]
# --- endregion ---


# --- region: exact-slide ---
def slide(held, q, v, gravity, enough):
    """While the K contacts push: their N bodies, the series Q (terms, 2, N) of q and lam (two
    terms less, K) of the forces, and how long they last [s].

    q'' = g + M^-1 J' lam with n = (q_i - q_j) / (r_i + r_j), a series too. n . n = 1 gives for each
    order of lam a linear system, always with the Delassus matrix. There are as many terms as make
    the series last for more than `enough` [s], to ORDER at most, but at least 5 of lam.
    """
    bodies = list(dict.fromkeys(body for contact in held for body in (contact.i, contact.j)))
    i, j = ([bodies.index(body) for body in column] for column in zip(*((c.i, c.j) for c in held)))
    w, pair = np.array([body.w for body in bodies]), np.array([not c.wall for c in held])
    reach, inverse = np.array([c.reach for c in held]), held.inverse
    body = [*i, *j, *(k + len(w) for k in (*i, *j))]

    def along(n, rows):
        return (n * (rows[:, i] - rows[:, j])).sum(0)

    def spread(force):                          # M^-1 (2, N) of forces (2, K) on i, -force on j
        both = np.concatenate((force, -force), 1).ravel()
        return np.bincount(body, both, 2 * len(w)).reshape(2, -1) * w

    Q, lam = np.zeros((ORDER + 1, 2, len(w))), np.zeros((ORDER - 1, len(held)))
    n = np.zeros((ORDER + 1, 2, len(held)))
    n[0] = np.transpose([(c.nx, c.ny) for c in held])
    Q[0], Q[1] = (np.transpose([rows[body] for body in bodies]) for rows in (q, v))
    Q[0] += spread(n[0] * applied(inverse, np.array([c.depth for c in held])))  # gap = 0
    n[0] = np.where(pair, (Q[0][:, i] - Q[0][:, j]) / reach, n[0])
    Q[1] -= spread(n[0] * applied(inverse, along(n[0], Q[1])))                  # v_n = 0
    for k in range(ORDER - 1):
        n[k + 1] = (Q[k + 1][:, i] - Q[k + 1][:, j]) / reach * pair
        a = spread((lam[:k, None] * n[k:0:-1]).sum(0))          # of the orders that are known
        a[1] += gravity * (w > 0.0) * (k == 0)
        turn = 0.5 * reach * (n[1:k + 2] * n[k + 1:0:-1]).sum((0, 1)) * (k + 1) * (k + 2)
        lam[k] = -applied(inverse, along(n[0], a) + turn)       # to close the gaps has turned n,
        lam[k] -= applied(inverse, along(n[0], a + spread(lam[k] * n[0])) + turn)   # so once more
        Q[k + 2] = (a + spread(lam[k] * n[0])) / ((k + 1) * (k + 2))
        if k > 3 and (span := lasting(bodies, Q[k + 1:k + 3], k + 1, gravity)) > enough:
            break
    return bodies, Q[:k + 3], lam[:k + 1], span
# --- endregion ---


# --- region: exact-expand ---
def lasting(bodies, last, k, gravity):
    """How long [s] a series lasts whose `last` two terms (2, 2, N) are of t^k and t^(k + 1).

    It is a power of 2, within which their rates stay below CUT of a body's speed sqrt(g r).
    """
    speed = np.array([math.sqrt(-gravity * b.radius) if b.w > 0.0 else math.inf for b in bodies])
    size = np.abs(last / (CUT * speed)).max((1, 2)) * (k, k + 1)        # size t^(k - 1) < 1
    return math.ldexp(1.0, int((-np.frexp(size)[1] // (k - 1, k)).min()))


def held_fast(held):
    """The balls of heaps with as many contacts as coordinates, which cannot move."""
    found, left = set(), set(range(len(held)))
    while left:
        heap = [left.pop()]                     # of contacts, that share balls
        for k in heap:                          # and grows while there are more
            more = left.intersection(held.couplings[k])
            left -= more
            heap += more
        balls = {body for k in heap for body in held[k].bodies if body.w > 0.0}
        if len(heap) == 2 * len(balls):
            found |= balls
    return found


def slips(contacts, v, a):
    """Whether bodies slide over one another, or begin to."""
    return any(contact.across(v) or contact.across(a) for contact in contacts)


def expand(held, q, v, a, gravity, enough):
    """The motion of the bodies while these contacts push: {body: (x, y)} of series of those that
    slide or are held fast, {contact: series of its force}, and how long they last [s].

    Where no held contact slides there is nothing to expand, for ever. Elsewhere a series need not
    last longer than `enough` [s], and has few terms where that is short.
    """
    if not slips(held, v, a):
        return {}, {}, math.inf
    fast = held_fast(held)                      # what they still move by is round-off
    series = {body: parabola(q[body], (0.0, 0.0), (0.0, 0.0)) for body in fast}
    loose = Group(contact for contact in held if fast.isdisjoint(contact.bodies)) if fast else held
    if not slips(loose, v, a):
        return series, {}, math.inf
    bodies, Q, lam, span = slide(loose, q, v, gravity, enough)
    # first_fall needs a start above 0: a force that begins at 0 ends once it has fallen by a graze
    share = np.array([contact.i.w + contact.j.w for contact in loose])
    lam[0] = np.maximum(lam[0], 0.0) - GRAZE * gravity / share
    for k, body in enumerate(bodies):
        if body.w > 0.0:
            series[body] = Q[:, :, k].T.tolist()
    return series, dict(zip(loose, lam.T.tolist())), span
# --- endregion ---


# --- region: exact-series ---
def evaluate(p, t):
    """sum p[k] t^k by Horner's rule; t a number or an array."""
    total = p[-1]
    for coefficient in p[-2::-1]:
        total = total * t + coefficient
    return total


def rate(p):
    """The series of the derivative."""
    return [k * coefficient for k, coefficient in enumerate(p) if k]


def shifted(p, s):
    """The series written about a time s later: Horner's rule again and again (Taylor shift)."""
    p = list(p)
    if s != 0.0:
        for k in range(len(p) - 1):
            for m in range(len(p) - 2, k - 1, -1):
                p[m] += s * p[m + 1]
    return p


def squared(p):
    """The series of the square, to the order that a series has at most; 3 numbers or more."""
    while len(p) > 2 and p[-1] == 0.0:
        p = p[:-1]
    square = [0.0] * min(2 * len(p) - 1, ORDER + 1)
    for k, a in enumerate(p):
        for m, b in enumerate(p[:len(square) - k]):
            square[k + m] += a * b
    return square


def parabola(q, v, a):
    """The series x and y of a motion with the acceleration a."""
    return [q[0], v[0], 0.5 * a[0]], [q[1], v[1], 0.5 * a[1]]


def reaches(x, y, span):
    """speed and bend: what moves by x and y goes no further than speed t + bend t^2 up to span."""
    path, bend, power = [abs(a) + abs(b) for a, b in zip(x, y)], 0.0, 1.0
    for part in path[2:]:
        bend += part * power
        power *= span
    return path[1], bend


def difference(p, q):
    """The series p - q."""
    return [a - b for a, b in zip_longest(p, q, fillvalue=0.0)]


def gap_series(contact, gap, dx, dy):
    """A series with the sign of a gap, which is `gap` at t = 0: y - r at the floor, and
    |q_i - q_j|^2 - (r_i + r_j)^2 of a pair. dx and dy are the series of q_i - q_j."""
    if contact.wall:
        return [gap, *dy[1:]]
    p = [a + b for a, b in zip_longest(squared(dx), squared(dy), fillvalue=0.0)]
    return [gap * (gap + 2.0 * contact.reach), *p[1:]]
# --- endregion ---


# --- region: exact-next ---
def first_fall(p, horizon):
    """First t in [0, horizon] at which sum p[k] t^k falls through zero; inf if it does not.

    p[0] >= 0. Newton's method made safe: with the least curvature up to the horizon no step passes
    a root, and a parabola takes one step. An answer is good to 1e-15 of itself, or early where 200
    steps of next to no curvature did not get there.
    """
    if not any(p[3:]):
        t = fall(*p[:3])
        return t if t <= horizon else math.inf
    t, slopes = 0.0, rate(p)
    bends = [0.5 * coefficient for coefficient in rate(slopes)]
    for _ in range(200):
        bend = lower_bound(bends, t, horizon)
        step = fall(max(evaluate(p, t), 0.0), evaluate(slopes, t), bend)
        t += step
        if not t <= horizon:
            return math.inf
        if step <= 1e-15 * t:
            break
    return t


def fall(value, slope, bend):
    """First t >= 0 at which value + slope t + bend t^2 falls through zero; inf or NaN if never."""
    square = slope * slope - 4.0 * value * bend
    if not square >= 0.0:
        return math.inf
    root = math.sqrt(square)
    if slope < 0.0:
        return 2.0 * value / (root - slope)
    return (slope + root) / (-2.0 * bend) if bend < 0.0 else math.inf


def lower_bound(p, t, horizon):
    """No sum p[k] s^k is less while t <= s <= horizon; exact for parabolas."""
    least = min(evaluate(p[:3], t), evaluate(p[:3], horizon))
    if p[2] > 0.0:
        vertex = min(max(-p[1] / (2.0 * p[2]), t), horizon)
        least = min(least, evaluate(p[:3], vertex))
    if any(p[3:]):
        least -= evaluate([0.0, 0.0, 0.0, *(abs(part) for part in p[3:])], horizon)
    return least
# --- endregion ---


# --- region: exact-calendar ---
class Calendar:
    """What happens next to which Body or Contact: a heap of what is due."""

    def __init__(self):
        self.heap, self.count = [], 0           # (time [s / SECOND], count for ties, what)

    def plan(self, time, what):
        """Something happens to a Body or a Contact at a time, unless its `due` changes before."""
        what.due = time
        if time < math.inf:
            self.count += 1
            heapq.heappush(self.heap, (time, self.count, what))

    def next(self):
        """The time of the next event."""
        while self.heap and self.heap[0][2].due != self.heap[0][0]:
            heapq.heappop(self.heap)
        return self.heap[0][0] if self.heap else math.inf

    def woken(self, now):
        """The balls to which something happens by the time `now`, in that order."""
        found = []
        while self.next() <= now < math.inf:
            found += [body for body in heapq.heappop(self.heap)[2].bodies if body.w > 0.0]
        return found
# --- endregion ---


# --- region: exact-motion ---
class Motion:
    """All bodies, where their homes are, and the Calendar of what happens to them."""

    def __init__(self, scene, gravity):
        self.gravity, self.restitution = gravity, scene.restitution
        rows = zip((1.0 / scene.mass).tolist(), scene.radius.tolist(), scene.q0.T.tolist(),
                   scene.v0.T.tolist())
        self.balls = [Body(*row) for row in rows]
        self.floor = Body(0.0, 0.0, [0.0, 0.0], [0.0, 0.0])
        self.number = {ball: k for k, ball in enumerate(self.balls)}
        self.calendar = Calendar()
        self.samples = 0                        # how many have been passed
        self.homes, self.reach = scene.q0.copy(), scene.radius.copy()
        for ball in self.balls:
            if ball.w > 0.0:
                ball.room = ROOM * ball.radius if len(self.balls) > FEW else math.inf
            self.reach[self.number[ball]] += ball.room
        for ball in self.balls:
            if ball.w > 0.0:
                self.move_home(ball, ball.home)

    def move_home(self, ball, q):
        """Make q the home of a ball, and find whom it can meet while they all stay near home."""
        k = self.number[ball]
        self.homes[:, k] = ball.home = q
        away = self.homes - self.homes[:, k:k + 1]
        meets = (away * away).sum(0) <= (self.reach + self.reach[k]) ** 2
        others = [self.balls[m] for m in np.flatnonzero(meets).tolist() if m != k]
        if q[1] <= self.reach[k]:
            others.insert(0, self.floor)
        for other in set(ball.near).difference(others):
            ball.near.pop(other).due = math.inf
            del other.near[ball]
        for other in others:
            if other not in ball.near:
                pair = (other, ball) if other in self.balls[:k] else (ball, other)
                ball.near[other] = other.near[ball] = Contact(*pair, self.gravity)

    def go_on(self, ball, now, x, y, span):
        """Let a ball move by these series for a time `span` [s], or until it may leave home."""
        ball.remember(self.samples)
        ball.x, ball.y, ball.start = x, y, now
        left = ball.room - math.dist((x[0], y[0]), ball.home)
        if left < 0.5 * ball.room:
            self.move_home(ball, (x[0], y[0]))
            left = ball.room
        if left < math.inf:
            speed, bend = reaches(x, y, span)
            span = min(span, fall(left, -speed, -bend))
        self.calendar.plan(later(now, span), ball)
# --- endregion ---


# --- region: exact-event ---
def event(motion, now, ball):
    """Settle the island of a ball to which something happens, and send it on its way. Its balls."""
    island, g = Island(now, ball), motion.gravity
    separate(island)
    contacts = touching(island)
    collide(island, contacts, motion.restitution)
    for contact in island.contacts:
        contact.rests = contact.pushes = False
    held, a = support(island, contacts, g)
    for contact in contacts:
        contact.touched(now, contact.along(island.v))
    enough = LONGER * island.quiet() or math.inf
    slides, forces, span = expand(held, island.q, island.v, a, g, enough)
    moved = []
    for ball in island.balls:
        x, y = slides.get(ball) or parabola(island.q[ball], island.v[ball], a[ball])
        if ball.due <= now or not ball.rests(x, y):
            motion.go_on(ball, now, x, y, span if ball in slides else math.inf)
            moved.append(ball)
    predict(motion, now, moved)
    for contact, force in forces.items():
        motion.calendar.plan(later(now, first_fall(force, span)), contact)
    return island.balls
# --- endregion ---


# --- region: exact-predict ---
def predict(motion, now, balls):
    """Find when the contacts of the balls, which have new series, will close.

    Those that rest count as 3 TOUCH radii open, so that round-off is no event. The distance of two
    bodies is never less than along the normal of now: where that leaves a gap, none closes.
    """
    contacts = dict.fromkeys(contact for ball in balls for contact in ball.near.values())
    series, q = {}, {}
    for contact in contacts:
        contact.due = math.inf
        if contact.pushes:
            continue
        i, j = contact.i, contact.j
        for body in (i, j):
            if body not in series:
                series[body] = [shifted(row, seconds(body.start, now)) for row in (body.x, body.y)]
                q[body] = (series[body][0][0], series[body][1][0])
        contact.look(q, now)
        dx, dy = map(difference, series[i], series[j])
        contact.follow(now, dx, dy)
        gap = max(-contact.depth, 0.0) + 3.0 * TOUCH * i.radius * contact.rests
        v_n = contact.nx * dx[1] + contact.ny * dy[1]
        span = seconds(now, min(i.due, j.due))
        if contact.depth > contact.small:       # it overlaps: that is mended at once
            motion.calendar.plan(now, contact)
        elif fall(gap, v_n, -reaches(dx, dy, span)[1]) <= span:
            span = first_fall(gap_series(contact, gap, dx, dy), span)
            motion.calendar.plan(later(now, span), contact)
# --- endregion ---


# --- region: exact-run ---
@np.errstate(all="ignore")
def simulate_exact(scene, times, gravity, report=lambda k: None):
    """q, v (S, 2, N) [m, m/s] at `times` (S,) [s], rising from 0, from event to event.

    The scene has q0, v0 (2, N), mass (inf: a fixed ball), radius (N,) and restitution; gravity
    [m/s^2] is along y, negative. report(k) is called after each event with the samples done.
    """
    motion, clock = Motion(scene, gravity), times.tolist()
    tick = TICK * math.sqrt(float(scene.radius.min()) / -gravity)
    now, events, until = 0, 0, later(0, tick)
    woken = [ball for ball in motion.balls if ball.w > 0.0]
    while motion.samples < len(clock):
        settled = set()
        for ball in woken:
            if ball not in settled:
                settled.update(event(motion, now, ball))
                events += 1
                report(motion.samples)
        soon = max(now, motion.calendar.next())
        if events > EVENTS * max(20, len(motion.balls)):
            soon = max(soon, later(now, 0.01 * tick))
        if soon >= until:
            events, until = 0, later(soon, tick)
        if soon > now:                          # at the start: after all events there
            motion.samples = bisect_right(clock, seconds(0, soon))
        now = soon
        woken = motion.calendar.woken(now)
    report(motion.samples)
    for ball in motion.balls:
        ball.remember(motion.samples)
    x, y = zip(*(ball.read(times) for ball in motion.balls))
    return tuple(np.moveaxis(np.array((x, y)), (0, 1, 2, 3), (2, 3, 0, 1)))
# --- endregion ---
