"""Closed forms of VALIDATION's section 1, each with its source; nothing here knows how the solver works."""
import math

import numpy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, linprog
from scipy.special import ellipj, ellipk, ellipkinc

GRAVITY = 9.81


# --- linear spring-dashpot without tension (Schwager and Poeschel 2007)
def contact_duration(zeta):
    """omega_0 t of an impact that ends when the force would pull."""
    s = math.sqrt(abs(1 - zeta * zeta))
    if zeta < 1:
        return (math.pi - math.atan2(2 * zeta * s, 1 - 2 * zeta * zeta)) / s
    return 2.0 if zeta == 1 else math.log((zeta + s) / (zeta - s)) / s


def restitution(zeta):
    return math.exp(-zeta * contact_duration(zeta))


def deepest(zeta):
    """d_max omega_0 / v_0."""
    if zeta == 0:
        return 1.0
    if zeta == 1:
        return math.exp(-1)
    s = math.sqrt(abs(1 - zeta * zeta))
    if zeta < 1:
        return math.exp(-zeta / s * math.atan2(s, zeta))
    return math.exp(-zeta / s * math.atanh(s / zeta))


def damping_ratio(e):
    """Inverse of restitution(), by bisection."""
    low, high = 0.0, 60.0
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if restitution(middle) > e else (low, middle)
    return (low + high) / 2


# --- contacts that yield: F1 = k1 d^n, unloaded along k2 d^n; energies in units of that of the first loading, overlaps of its largest
def plastic_restitution(plasticity, adhesive, n):
    """Of an impact without other losses. What comes back is the integral of k2 (x^n - s^n) from the dent s to 1; adhesion then takes that of the same from s on down
    to where it meets -k_adh x^n, and of that to 0. 0 where it takes all: the bodies stick."""
    ratio = 1 / (1 - plasticity)
    dent = plasticity ** (1 / n)
    least = dent * (ratio / (ratio + adhesive)) ** (1 / n)   # k2 (x^n - s^n) = -k_adh x^n
    area = lambda x: ratio * (x ** (n + 1) - (n + 1) * dent**n * x)
    back = area(1.0) - area(dent)
    lost = area(least) - area(dent) + adhesive * least ** (n + 1) if adhesive > 0 else 0.0
    return math.sqrt(max(0.0, back - lost))


def damped_plastic_restitution(plasticity, e):
    """Linear, of a dashpot 2 zeta sqrt(m k2) with the zeta of the restitution e, without adhesion; the force never pulls. m = k2 = 1, speed 1."""
    zeta, k1 = damping_ratio(e), 1 - plasticity
    loaded = solve_ivp(lambda t, y: (y[1], -k1 * y[0] - 2 * zeta * y[1]), (0, 100), (0.0, 1.0), events=_turns, rtol=1e-11, atol=1e-13)
    deepest = loaded.y_events[0][0][0]
    dent = plasticity * deepest

    def ends(t, y):
        return (y[0] - dent) + 2 * zeta * y[1]
    ends.terminal, ends.direction = True, -1
    left = solve_ivp(lambda t, y: (y[1], -(y[0] - dent) - 2 * zeta * y[1]), (0, 100), (deepest, 0.0), events=ends, rtol=1e-11, atol=1e-13)
    return -left.y_events[0][0][1]


def _turns(t, y):
    return y[1]


_turns.terminal, _turns.direction = True, -1


class Eepa:
    """Force of a contact as its overlap goes up and down, by the largest overlap (Thakur, Morrissey, Sun, Chen, Ooi, Granular Matter 16 (2014) 383, equations 2
    and 3; without adhesion that of Walton and Braun: the largest overlap stays)."""

    def __init__(self, stiffness, plasticity, adhesive, n):
        self.k1, self.k2, self.pull, self.n, self.most, self.branch = stiffness, stiffness / (1 - plasticity), adhesive * stiffness, n, 0.0, None

    def force(self, overlap):
        x = overlap**self.n
        self.most = max(self.most, x)
        unloaded = self.k2 * (x - (1 - self.k1 / self.k2) * self.most)
        if x == self.most:
            self.branch = "loaded"
            return self.k1 * x
        if unloaded > -self.pull * x or (self.pull == 0 and unloaded > 0):
            self.branch = "unloaded"
            return unloaded
        if self.pull == 0:
            self.branch = "unloaded"
            return 0.0
        self.branch = "adhesive"
        self.most = (self.k2 + self.pull) / (self.k2 - self.k1) * x
        return -self.pull * x


def hunt_crossley_alpha(e):
    """alpha = chi v_0 of the linear Hunt-Crossley law: alpha (1 + e) = ln((1 + alpha)/(1 - alpha e))."""
    low, high = 1e-12, 1 / e - 1e-12
    for _ in range(300):
        a = (low + high) / 2
        value = math.log((1 + a) / (1 - a * e)) - a * (1 + e)
        low, high = (a, high) if value < 0 else (low, a)
    return (low + high) / 2


def oblique_impact(angle, speed, radius, e, mu, rho=2 / 7, density=1000.0, dashpot=True, steps=20000):
    """Sphere on a rigid plane with linear springs, normal and tangential (rho = kt/kn): v_t'/v_t and w', by small steps.
    The tangential dashpot is sqrt(rho) times the normal one; without it this is the linear spring of validation plan 1.2."""
    m = density * 4 / 3 * math.pi * radius**3
    k, zeta = 1.0, 0.0 if e == 1 else damping_ratio(e)
    w0 = math.sqrt(k / m)
    c = 2 * zeta * math.sqrt(k * m)
    dt = math.pi / w0 / steps
    # lengths scale with the speed in a linear law: the contact may be as deep as it likes, levers stay `radius`
    d, vn, vt, w, xi = 0.0, speed * math.cos(angle), speed * math.sin(angle), 0.0, 0.0
    while True:
        normal = k * d + c * vn
        if d < 0 or normal < 0:
            break
        slip = vt - radius * w
        xi += slip * dt
        trial = rho * k * xi
        if abs(trial) > mu * normal:
            trial = math.copysign(mu * normal, trial)
            xi = trial / (rho * k)
        force = trial + (math.sqrt(rho) * c * slip if dashpot else 0.0)
        if abs(force) > mu * normal:
            force = math.copysign(mu * normal, force)
        vn -= normal / m * dt
        d += vn * dt
        vt -= force / m * dt
        w += force * radius / (0.4 * m * radius**2) * dt
    return vt / (speed * math.sin(angle)), w


def hunt_crossley_restitution(alpha):
    """Inverse of hunt_crossley_alpha()."""
    low, high = 1e-9, 1.0
    for _ in range(200):
        e = (low + high) / 2
        # the force stops to act where 1 - alpha e' = 0; e below 1/alpha always
        value = alpha * (1 + e) - math.log((1 + alpha) / (1 - alpha * e)) if alpha * e < 1 else -1.0
        low, high = (e, high) if value > 0 else (low, e)
    return (low + high) / 2


# --- Hertz
def hertz_impact(mass, speed, young, radius):
    """Largest depth, force, duration of an elastic impact; effective mass, effective modulus and effective radius."""
    depth = (15 * mass * speed**2 / (16 * young * math.sqrt(radius))) ** 0.4
    return depth, 4 / 3 * young * math.sqrt(radius) * depth**1.5, 2.94327518 * depth / speed


# --- impulses of rigid bodies
def impulse(mass, inertia, r, n, v, w, e, mu=0.0, t=None):
    """Velocities after an impact at r (from the centre) with unit normal n into the body; gross sliding along t when mu > 0."""
    n, r = numpy.asarray(n, float), numpy.asarray(r, float)
    direction = n if t is None else n - mu * numpy.asarray(t, float)
    turned = numpy.linalg.solve(inertia, numpy.cross(r, direction))
    approach = -n @ (v + numpy.cross(w, r))
    j = (1 + e) * approach / (n @ (direction / mass + numpy.cross(turned, r)))
    return v + j * direction / mass, w + j * turned


def pair_mobility(n, sides):
    """1/m_eff of a frictionless contact between bodies [(mass, inertia, r), ...]."""
    total = 0.0
    for mass, inertia, r in sides:
        c = numpy.cross(r, n)
        total += 1 / mass + c @ numpy.linalg.solve(inertia, c)
    return total


def kodam(theta, diameter=8e-3, length=5e-3, density=1200.0, speed=1.0, e=0.85):
    """Cylinder on its end rim (Kodam et al. 2010, Park 2003): v_z' and omega'. theta between axis and plane [rad]."""
    mass = density * math.pi * diameter**2 / 4 * length
    inertia = mass * (diameter**2 / 16 + length**2 / 12)
    x = -length / 2 * math.cos(theta) + diameter / 2 * math.sin(theta)
    shared = (1 + e) * speed / (inertia + mass * x * x)
    return -speed + shared * inertia, -mass * x * shared


# --- free rotation (Jacobi)
def free_rotation(inertia, w0, t):
    """Body-frame angular velocity at t for principal moments I1 < I2 < I3 and any start, by elliptic functions."""
    I1, I2, I3 = inertia
    w0 = numpy.asarray(w0, float)
    energy2 = float((numpy.asarray(inertia) * w0**2).sum())
    L2 = float(((numpy.asarray(inertia) * w0) ** 2).sum())
    swap = L2 < energy2 * I2
    if swap:  # exchange the roles of axes 1 and 3
        I1, I3 = I3, I1
        w0 = w0[::-1]
    A1 = math.sqrt((energy2 * I3 - L2) / (I1 * (I3 - I1)))
    A2 = math.sqrt((energy2 * I3 - L2) / (I2 * (I3 - I2)))
    A3 = math.sqrt((L2 - energy2 * I1) / (I3 * (I3 - I1)))
    rate = math.sqrt((I3 - I2) * (L2 - energy2 * I1) / (I1 * I2 * I3))
    m = (I2 - I1) * (energy2 * I3 - L2) / ((I3 - I2) * (L2 - energy2 * I1))
    s1, s3 = (1.0 if w0[0] >= 0 else -1.0), (1.0 if w0[2] >= 0 else -1.0)
    s2 = s1 * s3  # Euler's equations fix the third sign, also after the exchange, which is a reflection
    sine, cosine = w0[1] / (A2 * s2), w0[0] / (A1 * s1)
    u0 = ellipkinc(math.atan2(sine, cosine), m)
    sn, cn, dn, _ = ellipj(rate * t + u0, m)
    w = numpy.array([s1 * A1 * cn, s2 * A2 * sn, s3 * A3 * dn])
    return (w[::-1] if swap else w), 4 * ellipk(m) / rate


def free_orientation(inertia, w0, t):
    """Orientation of a free body (w x y z) by an integration of high order; for times without a printed value."""
    I = numpy.asarray(inertia, float)

    def rate(_, y):
        q, w = y[:4], y[4:]
        dq = 0.5 * numpy.array([-q[1:] @ w, *(q[0] * w + numpy.cross(q[1:], w))])
        return numpy.concatenate([dq, -numpy.cross(w, I * w) / I])
    s = solve_ivp(rate, [0, t], [1, 0, 0, 0, *w0], method="DOP853", rtol=3e-14, atol=1e-14)
    return s.y[:4, -1] / numpy.linalg.norm(s.y[:4, -1])


# --- Housner's rocking block
def housner_quarter(alpha, p, fraction):
    """Time from rest at theta = fraction alpha to upright, and the speed there: theta'' = -p^2 sin(alpha - theta)."""
    def upright(_, y):
        return y[0]
    upright.terminal = True
    s = solve_ivp(lambda _, y: [y[1], -p * p * math.sin(alpha - y[0])], [0, 100], [fraction * alpha, 0.0], events=upright,
                  rtol=1e-12, atol=1e-14)
    return s.t_events[0][0], abs(s.y_events[0][0][1])


# --- rigid blocks in a plane: loads at given points (Heyman's static theorem)
def can_stand(blocks, contacts, mu, down=(0, -1)):
    """Can blocks be in equilibrium under their weights with friction mu? By linear programming: is there a set of loads within the cones?

    blocks [(x, z, weight)]; contacts [(a, b, point, normal)]: load on block b (an index, or None for the ground) comes from a,
    unit normal into b; down: where weights pull. Without it nothing can stand; with it a set of loads exists (Heyman 1966), which with
    friction that depends on the load need not be the one that comes.
    """
    columns = []
    for a, b, point, normal in contacts:
        n = numpy.asarray(normal, float)
        t = numpy.array([n[1], -n[0]])
        for direction in (n + mu * t, n - mu * t):  # the edges of the cone
            column = numpy.zeros(3 * len(blocks))
            for body, sign in ((a, -1), (b, 1)):
                if body is not None:
                    rx, rz = numpy.asarray(point, float) - blocks[body][:2]
                    column[3 * body:3 * body + 3] += sign * numpy.array([*direction, rx * direction[1] - rz * direction[0]])
            columns.append(column)
    load = numpy.concatenate([[-weight * down[0], -weight * down[1], 0] for _, _, weight in blocks])
    scale = max(weight for _, _, weight in blocks)
    result = linprog(numpy.ones(len(columns)), A_eq=numpy.array(columns).T, b_eq=load / scale, bounds=(0, None), method="highs")
    return result.status == 0


def threshold(holds, low, high, tolerance=1e-6):
    """Where a statement becomes true between low, where it is false, and high; None where it is false there, too."""
    if not holds(high):
        return None
    while high - low > tolerance * max(abs(low), abs(high)):
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def least_friction(blocks, contacts, highest=4.0):
    """Smallest coefficient of friction for which blocks can be in equilibrium under their weights. None if friction alone cannot help."""
    return threshold(lambda mu: can_stand(blocks, contacts, mu), 0.0, highest, 1e-9)


def ladder_angle(length, thickness, margin, mu):
    """Steepness from the floor [rad] below which a uniform ladder slides, floor and wall with the same friction. It touches with
    the corners below and behind, balls of the margin. Without thickness tan a = (1 - mu^2) / (2 mu)."""
    def surplus(a):
        along, across = numpy.array([math.cos(a), math.sin(a)]), numpy.array([math.sin(a), -math.cos(a)])
        foot = -length / 2 * along + thickness / 2 * across + [0, -margin]
        head = length / 2 * along + thickness / 2 * across + [margin, 0]
        wall = mu / (1 + mu * mu)  # normal load of the wall over the weight when both slide
        return -foot[0] * 1.0 - wall * (head[1] - foot[1]) - mu * wall * (head[0] - foot[0])
    return brentq(surplus, math.radians(5), math.radians(85))


def sticky_rebound(speed, e, mass, stiffness, pull_off, reach, steps=4000):
    """Speed at which a body leaves a surface that attracts it (force rising linearly to pull_off over `reach` beyond touch, constant in
    contact), 0 where it stays. The contact is a linear spring with the dashpot of restitution e, which cannot pull.

    Beyond touch the energy decides; in contact the equation of motion is integrated (classical Runge-Kutta), up to three contact times."""
    omega, work = math.sqrt(stiffness / mass), pull_off * reach / mass
    damping = 2 * damping_ratio(e) * omega

    def rate(d, v):   # of the overlap d and its rate v
        return v, pull_off / mass - max(0.0, omega**2 * d + damping * v)

    d, v, h = 0.0, math.sqrt(speed**2 + work), math.pi / omega / steps
    for _ in range(3 * steps):
        before, v_before = d, v
        k1 = rate(d, v)
        k2 = rate(d + .5 * h * k1[0], v + .5 * h * k1[1])
        k3 = rate(d + .5 * h * k2[0], v + .5 * h * k2[1])
        k4 = rate(d + h * k3[0], v + h * k3[1])
        d += h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        v += h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        if d < 0:   # to the moment of touch
            share = before / (before - d)
            left = (v_before + share * (v - v_before))**2 - work
            return math.sqrt(left) if left > 0 else 0.0
    return 0.0


def sticking_speed(e, mass, stiffness, pull_off, reach):
    """Below it a body stays with the surface that attracts it: see sticky_rebound()."""
    low, high = 0.0, 100 * math.sqrt(pull_off * reach / mass)
    for _ in range(40):
        middle = .5 * (low + high)
        low, high = (middle, high) if sticky_rebound(middle, e, mass, stiffness, pull_off, reach) == 0 else (low, middle)
    return high


def jkr(overlap, w, modulus, radius):
    """Force and energy (0 as the neck tears) of two balls that stick (Johnson, Kendall, Roberts 1971), from the radius of the contact."""
    pull_off = 1.5 * math.pi * w * radius
    tear = .75 * (math.pi**2 * w**2 * radius / modulus**2)**(1 / 3)
    least = (math.pi * w * radius**2 / (8 * modulus))**(1 / 3)

    def overlap_of(a):
        return a * a / radius - math.sqrt(2 * math.pi * w * a / modulus)

    def force_of(a):
        return 4 * modulus * a**3 / (3 * radius) - math.sqrt(8 * math.pi * w * modulus * a**3)

    low, high = least, 2 * least + math.sqrt(radius * max(overlap, 0)) + (radius**2 * w / modulus)**(1 / 3) * 4
    for _ in range(200):
        middle = .5 * (low + high)
        low, high = (middle, high) if overlap_of(middle) < overlap else (low, middle)
    radii = numpy.linspace(least, low, 20001)
    slopes = 2 * radii / radius - .5 * numpy.sqrt(2 * math.pi * w / (modulus * radii))
    integrand = (4 * modulus * radii**3 / (3 * radius) - numpy.sqrt(8 * math.pi * w * modulus * radii**3)) * slopes
    energy = float(((integrand[1:] + integrand[:-1]) / 2 * numpy.diff(radii)).sum())
    return {"force": force_of(low), "energy": energy, "pull_off": pull_off, "tear_off": tear}


def bridge_rupture(angle, volume, radius, lian):
    """Gap at which a liquid bridge breaks: Willett et al. 2000, or Lian et al. 1993. radius: of either of two equal balls."""
    return (1 + angle / 2) * (volume**(1 / 3) + (0 if lian else .1 * volume**(2 / 3) / radius))


def bridge_force(gap, tension, angle, volume, radius):
    """Of a liquid bridge that has not broken: Willett et al. 2000, equation 13."""
    x = .5 * gap / numpy.sqrt(volume / radius)
    return 2 * math.pi * radius * tension * math.cos(angle) / (1 + 2.1 * x + 10 * x * x)


def bridge_work(tension, angle, volume, radius, lian):
    """Work that parts two balls from touch, by quadrature."""
    gaps = numpy.linspace(0, bridge_rupture(angle, volume, radius, lian), 20001)
    forces = bridge_force(gaps, tension, angle, volume, radius)
    return float(((forces[1:] + forces[:-1]) / 2 * numpy.diff(gaps)).sum())


def domino_speed(height, thickness, gap, gravity=GRAVITY, stones=80):
    """Speed of the wave that falls through an endless row of slabs without friction between them, each of which turns about its front lower edge; gap: free, between
    faces. The slabs behind the front lean on each other, one degree of freedom: h sin(a - b) = p cos b - d for a slab at the lean a and the next one at b, pitch p.
    When the front slab meets the next one, it joins without rebound: the momentum of the joined row is that of the row before. Between such joints energy is kept.
    The row of the last `stones` slabs: those before lie still. Method: as van Leeuwen, Am. J. Phys. 78 (2010) 721, without friction."""
    pitch, meets = gap + thickness, math.asin(gap / height)
    inertia = (height**2 + thickness**2) / 3   # about the edge, of unit mass

    def row(front):
        """Angular velocities over that of the front slab, and the potential energy."""
        lean, rate, rates, potential = front, 1.0, [], 0.0
        for _ in range(stones):
            rates.append(rate)
            potential += gravity * (height * math.cos(lean) + thickness * math.sin(lean)) / 2
            # h cos(a - b) (a' - b') = -p sin b b'
            off = (pitch * math.cos(lean) - thickness) / height
            rate *= 1 - pitch * math.sin(lean) / (height * math.sqrt(1 - off**2))
            lean += math.asin(off)
        return sum(r * r for r in rates), potential

    places = meets * 0.5 * (1 - numpy.polynomial.legendre.leggauss(40)[0])
    weights = meets * 0.5 * numpy.polynomial.legendre.leggauss(40)[1]
    sums, potentials = numpy.array([row(place) for place in places]).T
    first, first_potential = row(0.0)
    last, last_potential = row(meets)
    spin = 1.0
    for _ in range(400):   # of the front slab as it begins to turn, until it repeats
        energy = inertia * first * spin**2 / 2 + first_potential
        before = math.sqrt(2 * (energy - last_potential) / (inertia * last))
        after = before * last / (last + 1)
        if abs(after - spin) < 1e-13 * after:
            break
        spin = after
    time = float((weights / numpy.sqrt(2 * (energy - potentials) / (inertia * sums))).sum())
    return pitch / time
