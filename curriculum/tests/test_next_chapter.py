"""What the next chapter builds from Ball, Contact, detect_contacts and solve_contacts, unchanged.

Seen from above, a disc that a servo drives pushes a T: two discs held apart by a rod, with viscous
drag in place of the table's friction. No gravity, no floor. Then a block that turns, as a subclass
with an arm and an inertia. Each is held to closed forms.
"""

import math
from types import SimpleNamespace

import pytest

import contact
from contact import Ball, Contact

DT = 0.01
ROD = 0.06  # m, between the two discs of the T
BAR, STEM = 0.06, 0.045  # kg


def make_table(angle=0.0, pusher_mass=0.5, speed=0.0):
    """A pusher left of a T whose rod stands at `angle` to the x axis, far from y = 0."""
    bar = Ball(0.0, 5.0, 0.0, 0.0, BAR, 0.032)
    stem = Ball(ROD * math.cos(angle), 5.0 + ROD * math.sin(angle), 0.0, 0.0, STEM, 0.026)
    pusher = Ball(-0.06, 5.0, speed, 0.0, pusher_mass, 0.015)
    return SimpleNamespace(pusher=pusher, bar=bar, stem=stem, balls=[pusher, bar, stem])


def rod_force(bar, stem, stiffen=20.0):
    """Chapter 3.4's multiplier of d.d = ROD^2 with Baumgarte's two terms, as forces on both."""
    dx, dy = bar.x - stem.x, bar.y - stem.y
    ux, uy = bar.vx - stem.vx, bar.vy - stem.vy
    off, rate = 0.5 * (dx * dx + dy * dy - ROD * ROD), dx * ux + dy * uy
    pull = ux * ux + uy * uy + 2.0 * stiffen * rate + stiffen * stiffen * off
    pull /= (bar.inv_mass + stem.inv_mass) * (dx * dx + dy * dy)
    return -pull * dx, -pull * dy


def push_contacts(table):
    """The contacts of the pusher alone: no floor here, and the rod holds the other two."""
    return [
        c
        for c in contact.detect_contacts(table.balls)
        if c.a is table.pusher and c.b is not contact.FLOOR
    ]


def step(table, command=None, gain=20.0, drag=0.0):
    """One step: rod and drag, the servo towards the velocity `command`, contacts, then move."""
    fx, fy = rod_force(table.bar, table.stem)
    for ball, sign in ((table.bar, 1.0), (table.stem, -1.0)):
        ball.vx += DT * (sign * fx * ball.inv_mass - drag * ball.vx)
        ball.vy += DT * (sign * fy * ball.inv_mass - drag * ball.vy)
    if command is not None:
        table.pusher.vx += DT * gain * (command[0] - table.pusher.vx)
        table.pusher.vy += DT * gain * (command[1] - table.pusher.vy)
    contacts = push_contacts(table)
    for c in contacts:
        c.target = contact.contact_target(c, 0.0, 0.2, DT)
    contact.solve_contacts(contacts, 10)
    assert all(c.lam >= 0.0 for c in contacts), "a contact pulled"
    contact.move(table.balls, DT)
    return sum(c.lam for c in contacts)


def momentum(balls):
    """Along x, along y, and angular about the origin."""
    return (
        sum(b.mass * b.vx for b in balls),
        sum(b.mass * b.vy for b in balls),
        sum(b.mass * (b.x * b.vy - b.y * b.vx) for b in balls),
    )


def turn(table):
    """The angle of the rod, from the bar to the stem."""
    return math.atan2(table.stem.y - table.bar.y, table.stem.x - table.bar.x)


def test_pushing_in_line_settles_at_the_speed_at_which_servo_and_drag_balance():
    """Servo M gain (u - V) = drag c (m_bar + m_stem) V, and the contact carries exactly that."""
    table, u, gain, drag = make_table(), 0.2, 20.0, 8.0
    for _ in range(400):
        lam = step(table, (u, 0.0), gain, drag)
    servo, block = 0.5 * gain, drag * (BAR + STEM)
    expected = u * servo / (servo + block)
    for ball in table.balls:
        assert ball.vx == pytest.approx(expected, rel=1e-9) and ball.vy == 0.0
    assert lam == pytest.approx(DT * block * expected, rel=1e-9)


def test_without_servo_and_drag_no_momentum_is_lost_linear_or_angular():
    """Rod and contacts act along lines of centres, so a step keeps all three to rounding."""
    table = make_table(angle=1.0, speed=0.3)
    before, turned = momentum(table.balls), turn(table)
    pushed = sum(step(table) > 0.0 for _ in range(100))
    assert pushed > 0 and abs(turn(table) - turned) > 0.1
    assert momentum(table.balls) == pytest.approx(before, rel=1e-12, abs=1e-14)


def test_the_t_turns_about_its_centre_of_mass_after_the_push_and_the_rod_holds():
    """J of the T about its centre is m1 m2 / (m1 + m2) ROD^2; its spin is L / J from then on."""
    table = make_table(angle=math.pi / 2, speed=0.3)
    while step(table) == 0.0:
        pass
    for _ in range(10):
        step(table)
    table.pusher.vx = -1.0  # taken away
    block, total = [table.bar, table.stem], BAR + STEM
    vx, vy = (part / total for part in momentum(block)[:2])
    cx = sum(b.mass * b.x for b in block) / total
    cy = sum(b.mass * b.y for b in block) / total
    spin = (momentum(block)[2] - total * (cx * vy - cy * vx)) / (BAR * STEM / total * ROD * ROD)
    assert spin > 0.5, "hit below the centre, towards +x: it must turn left"
    start, steps = turn(table), 20
    for _ in range(steps):
        assert step(table) == 0.0
    swept = (turn(table) - start) % (2.0 * math.pi)
    assert swept == pytest.approx(spin * steps * DT, rel=0.02)
    assert math.hypot(table.bar.x - table.stem.x, table.bar.y - table.stem.y) == pytest.approx(
        ROD, rel=0.02
    )


@pytest.mark.parametrize("angle", [0.5, -0.5])
def test_a_mirrored_push_gives_the_mirrored_path(angle):
    table, mirror = make_table(angle), make_table(-angle)
    for _ in range(150):
        step(table, (0.2, 0.0), drag=8.0)
        step(mirror, (0.2, 0.0), drag=8.0)
    for ball, other in zip(table.balls, mirror.balls):
        assert ball.x == pytest.approx(other.x, abs=1e-12)
        assert ball.y - 5.0 == pytest.approx(5.0 - other.y, abs=1e-12)
    assert abs(turn(table) - angle) > 0.05, "pushed off its centre, it must turn"


def test_a_pusher_that_nothing_moves_keeps_its_velocity_and_goes_through_nothing():
    table = make_table(angle=0.3)
    table.pusher = table.balls[0] = Ball(-0.06, 5.0, 0.2, 0.0, math.inf, 0.015)
    for _ in range(200):
        step(table, drag=8.0)
        for c in push_contacts(table):
            assert c.depth < 0.05 * table.pusher.radius
    assert (table.pusher.vx, table.pusher.vy) == (0.2, 0.0)
    assert table.pusher.x == pytest.approx(-0.06 + 0.2 * 2.0)


def test_two_bodies_that_nothing_moves_are_left_alone():
    a, b = Ball(0, 0, 1.0, 0, math.inf, 1.0), Ball(1, 0, 0, 0, math.inf, 1.0)
    c = Contact(a, b, -1.0, 0.0, 1.0)
    c.target = 1.0
    contact.solve_contacts([c], 20)
    assert (a.vx, b.vx, c.lam) == (1.0, 0.0, 0.0)


# A block that turns: a Ball with an angular velocity, a Contact with an arm


class Block(Ball):
    """A body that turns: `inertia` [kg m^2] about its centre, angular velocity `spin` [1/s]."""

    def __init__(self, x, y, vx, vy, mass, inertia, spin=0.0):
        super().__init__(x, y, vx, vy, mass, 0.0)
        self.inertia, self.spin = inertia, spin

    def kinetic(self):
        speed = self.vx * self.vx + self.vy * self.vy
        return 0.5 * (self.mass * speed + self.inertia * self.spin * self.spin)


class CornerContact(Contact):
    """A block's corner on the floor, at (rx, ry) from the block's centre."""

    def __init__(self, block, rx, ry, depth=0.0):
        super().__init__(block, contact.FLOOR, 0.0, 1.0, depth)
        self.lever = rx * self.ny - ry * self.nx  # r x n
        self.m_eff = 1.0 / (block.inv_mass + self.lever * self.lever / block.inertia)

    def v_n(self):
        return super().v_n() + self.a.spin * self.lever

    def push(self, impulse):
        super().push(impulse)
        self.a.spin += impulse * self.lever / self.a.inertia


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("rx", [-0.2, 0.0, 0.3])
def test_a_corner_that_strikes_gets_the_impulse_of_the_closed_form(restitution, rx):
    """lam = (1 + e) v / (1/m + rx^2/I); energy falls by (1 - e^2) m_eff v^2 / 2 and no more."""
    block, speed = Block(0, 0.1, 0.4, -2.0, mass=1.5, inertia=0.02), 2.0
    before, corner = block.kinetic(), CornerContact(block, rx, -0.1)
    corner.target = -restitution * corner.v_n()
    contact.solve_contacts([corner], 5)
    m_eff = 1.0 / (1.0 / 1.5 + rx * rx / 0.02)
    assert corner.lam == pytest.approx((1.0 + restitution) * speed * m_eff, rel=1e-14)
    assert block.vy == pytest.approx(-speed + corner.lam / 1.5, rel=1e-14, abs=1e-15)
    assert block.spin == pytest.approx(rx * corner.lam / 0.02, rel=1e-14)
    assert block.vx == 0.4
    lost = 0.5 * (1.0 - restitution**2) * m_eff * speed * speed
    assert before - block.kinetic() == pytest.approx(lost, rel=1e-12, abs=1e-14)


def test_a_block_at_rest_shares_its_weight_between_its_corners_by_the_lever_rule():
    """Corners at -a and b of the centre carry m g b / (a + b) and m g a / (a + b)."""
    block, a, b = Block(0, 0.1, 0, 0, mass=2.0, inertia=0.03), 0.1, 0.3
    corners = [CornerContact(block, -a, -0.1), CornerContact(block, b, -0.1)]
    contact.fall([block], 0.002)
    contact.solve_contacts(corners, 500)
    weight = 2.0 * -contact.GRAVITY * 0.002
    assert [c.lam for c in corners] == pytest.approx(
        [weight * b / (a + b), weight * a / (a + b)], rel=1e-9
    )
    assert abs(block.vy) < 1e-12 and abs(block.spin) < 1e-10


def test_a_block_whose_centre_is_beyond_its_corners_tips_about_the_nearer_one():
    """One corner pushes, the other lifts off: spin = m g a dt / (I + m a^2) after one step."""
    block, a = Block(0, 0.1, 0, 0, mass=2.0, inertia=0.03), 0.1
    corners = [CornerContact(block, -a - 0.2, -0.1), CornerContact(block, -a, -0.1)]
    contact.fall([block], 0.002)
    contact.solve_contacts(corners, 500)
    assert corners[0].lam == 0.0 and corners[0].v_n() > 0.0
    spin = 2.0 * contact.GRAVITY * a * 0.002 / (0.03 + 2.0 * a * a)
    assert block.spin == pytest.approx(spin, rel=1e-12)


def test_a_rod_struck_at_its_centre_of_percussion_does_not_move_its_far_end():
    """A uniform rod of length L struck at L/6 beyond its middle turns about its other end."""
    length, mass = 0.6, 1.2
    rod = Block(0, 0.0, 0, 0, mass, mass * length**2 / 12.0)
    struck = CornerContact(rod, length / 6.0, 0.0)
    struck.target = 1.0
    contact.solve_contacts([struck], 3)
    assert rod.vy - rod.spin * length / 2.0 == pytest.approx(0.0, abs=1e-14)
    assert struck.v_n() == pytest.approx(1.0, rel=1e-14)
