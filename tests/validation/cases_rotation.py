"""R: free rotation against Jacobi's solution (validation plan 1.5)."""
import math

import numpy

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case, inverse, quaternion, rotated

CASES = []
case = case_of(CASES)

INERTIA = (1 / 30, .34 / 3, .4 / 3)  # of the box 0.4 x 0.2 x 0.1 with mass 8
# validation plan 1.5: body angular velocity and orientation (w x y z)
JACOBI = {"R1": {1: ((-1.914759158752, -.281010163039, 3.415596966274), (-.2156635263, .0310759697, .1933742762, .9566242297)),
                 10: ((.197551123061, -2.326627688869, 2.835317697582), (.4228517539, -.3100925385, .0549651270, -.8497163330))},
          "R2": {1: ((8.082115287249, -1.988722795730, -8.081496613647), (.1807161123, .0321527822, -.6069381730, .7732618828)),
                 2: ((.108234449908, -9.999873918606, .041408889709), None)}}


def free_box(tools, name, w0, duration, step, every, q=(1, 0, 0, 0), **more):
    c = Case(name, duration=duration, step=step, every=every, **more)
    c.shape_file("box", exact_box(tools))
    c.material("m", 1000.0)
    c.pair_all(stiffness=1.0, restitution=1.0)
    c.tables["contact"]["margin"] = 0.001
    c.body("box", "m", (0, 0, 0), orientation=q, angular_velocity=rotated(numpy.asarray(q), w0))
    return c.run(tools)


def exact_box(tools):
    import os
    path = os.path.join(tools.scratch, "exact_box.shape.h5")
    if not os.path.exists(path):
        tools.call("scree-mesher", "generate", "box", "--size", "0.4,0.2,0.1", "-o", path)
    return path


def angle_between(p, q):
    """Angle of the rotation from p to q."""
    p, q = numpy.asarray(p, float), numpy.asarray(q, float)
    d = min(numpy.linalg.norm(p - q), numpy.linalg.norm(p + q))
    return 4 * math.asin(min(1.0, d / 2))


def conserved(run):
    """Energy and angular momentum (world) at the frames."""
    body = rotated(inverse(run.q[:, 0]), run.w[:, 0])
    inertia = numpy.array(INERTIA)
    return 0.5 * (inertia * body**2).sum(axis=1), rotated(run.q[:, 0], inertia * body)


@case("R1", "U", "torque-free rotation of a box", "Jacobi; Landau and Lifshitz, Mechanics 37")
def r1(tools, report):
    jacobi(tools, report, "R1", (1, 2, 3), (1, 10), 10.0)
    demand_at_coarse_step(tools, report, "R1", (1, 2, 3), 10.0, 2.6e-4)


@case("R2", "U", "rotation about the middle axis flips (Dzhanibekov)", "Jacobi")
def r2(tools, report):
    jacobi(tools, report, "R2", (.1, 10, 0), (1, 2), 2.0)
    demand_at_coarse_step(tools, report, "R2", (.1, 10, 0), 5.0, 2.8e-3)
    period = cf.free_rotation(INERTIA, (.1, 10, 0), 0)[1]
    run = report.run(free_box(tools, "R2-flips", (.1, 10, 0), 12.0, 4e-4, 2e-2))
    w2 = rotated(inverse(run.q[:, 0]), run.w[:, 0])[:, 1]
    crossing = [run.times[i] + (run.times[i + 1] - run.times[i]) * w2[i] / (w2[i] - w2[i + 1]) for i in range(len(w2) - 1) if w2[i] * w2[i + 1] < 0]
    report.check("flip interval, mean of the first six", numpy.diff(crossing[:7]).mean(), period / 2, 1e-4)


def demand_at_coarse_step(tools, report, name, w0, duration, limit):
    run = free_box(tools, f"{name}-coarse", w0, duration, 5e-3, duration)
    error = angle_between(run.q[-1, 0], cf.free_orientation(INERTIA, w0, duration))
    report.run(run, error_traj=error)
    report.at_most(f"orientation error at t = {duration:g}, step 5e-3 [rad]", error, limit)


def jacobi(tools, report, name, w0, times, duration):
    # halving the step must quarter the error (kdk-dlm is of second order), and the extrapolation must hit the closed form
    runs = [report.run(free_box(tools, f"{name}-{n}", w0, duration, 1e-3 / n, 1.0)) for n in (1, 2, 4)]
    for t in times:
        expected_w, expected_q = JACOBI[name][t]
        report.at_most(f"t = {t}: closed form recomputed against the printed one", numpy.abs(cf.free_rotation(INERTIA, w0, t)[0] - expected_w).max(), 1e-10)
        w = []
        for run in runs:
            i = int(numpy.argmin(abs(run.times - t)))
            assert abs(run.times[i] - t) < 1e-9
            w.append(rotated(inverse(run.q[i, 0]), run.w[i, 0]))
            q = run.q[i, 0]
        errors = [numpy.abs(v - expected_w).max() for v in w]
        report.check(f"t = {t}: order of the error in w", math.log2(errors[0] / errors[2]) / 2, 2.0, 0.1, "absolute")
        extrapolated = (64 * w[2] - 20 * w[1] + w[0]) / 45  # even orders of a symmetric scheme
        report.check(f"t = {t}: w extrapolated to step 0, largest error", numpy.abs(extrapolated - expected_w).max(), 0, 1e-6, "absolute")
        if expected_q:
            report.at_most(f"t = {t}: orientation error at step 2.5e-4 [rad]", angle_between(q, expected_q), 2e-5 if name == "R1" else 1e-3)
    energy, momentum = conserved(runs[0])
    report.at_most("|dL|/L", numpy.linalg.norm(momentum - momentum[0], axis=1).max() / numpy.linalg.norm(momentum[0]), 1e-13)


@case("R4", "N", "free rotation over 1e6 steps: energy offset without slope", "validation plan 4.1")
def r4(tools, report):
    for name, w0, limit in (("R1", (1, 2, 3), 6e-6), ("R2", (.1, 10, 0), 6e-6)):
        run = report.run(free_box(tools, f"R4-{name}", w0, 5000.0, 5e-3, 10.0))
        energy, momentum = conserved(run)
        relative = energy / energy[0] - 1
        report.at_most(f"{name}: mean energy offset", abs(relative.mean()), limit)
        slope = numpy.polyfit(run.times, relative, 1)[0] * run.times[-1]
        noise = numpy.std(relative) / math.sqrt(len(relative)) * math.sqrt(12)
        report.at_most(f"{name}: |slope| T over the scatter of a slope of noise", abs(slope) / noise, 4.0)
        report.at_most(f"{name}: |dL|/L", numpy.linalg.norm(momentum - momentum[0], axis=1).max() / numpy.linalg.norm(momentum[0]), 1e-13)


@case("R3", "U", "symmetric top: two precessions over 100 turns", "closed form")
def r3(tools, report):
    # 0.2 x 0.2 x 0.1: I1 = I2 < I3
    import os
    path = os.path.join(tools.scratch, "top.shape.h5")
    tools.call("scree-mesher", "generate", "box", "--size", "0.2,0.2,0.1", "-o", path)
    m = 4.0
    I1, I3 = m / 12 * (.04 + .01), m / 12 * .08
    w0 = numpy.array([1.0, 0.0, 5.0])
    L = numpy.array([I1 * w0[0], 0, I3 * w0[2]])
    space, body = numpy.linalg.norm(L) / I1, (I3 - I1) / I1 * w0[2]
    duration = 100 * 2 * math.pi / space
    errors = []
    for n in (1, 2):
        c = Case(f"R3-{n}", duration=duration, step=4e-4 / n, every=duration / 20, margin=0.001)
        c.shape_file("top", path)
        c.material("m", 1000.0)
        c.pair_all(stiffness=1.0, restitution=1.0)
        c.body("top", "m", (0, 0, 0), angular_velocity=w0)
        run = report.run(c.run(tools))
        # exact: q(t) = rotation about L by space precession, times rotation about the body's axis by minus the body precession
        worst = 0.0
        for t, q in zip(run.times, run.q[:, 0]):
            exact = product(quaternion(L, space * t), quaternion((0, 0, 1), -body * t))
            worst = max(worst, angle_between(q, exact))
        errors.append(worst)
    report.at_most("orientation after 100 turns [rad], step 2e-4", errors[1], 1e-3)
    report.check("order of the error", math.log2(errors[0] / errors[1]), 2.0, 0.1, "absolute")


def product(p, q):
    return numpy.concatenate([[p[0] * q[0] - p[1:] @ q[1:]], p[0] * q[1:] + q[0] * p[1:] + numpy.cross(p[1:], q[1:])])


@case("R5", "U", "orientations stay unit quaternions at any spin", "METHODS defect 11")
def r5(tools, report):
    # spins with |w| h of 0, 1e-300, 1e-8, 1e-4, pi - 1e-9, pi, 10, about odd axes, of a cube and of a box
    step, steps = 1e-3, 1000
    angles = [0.0, 1e-300, 1e-8, 1e-4, math.pi - 1e-9, math.pi, 10.0]
    c = Case("R5", duration=steps * step, step=step, every=steps * step / 10, margin=0.001)
    c.shape_file("box", exact_box(tools))
    c.mesh("cube", meshes.box((.1, .1, .1)))
    c.material("m", 1000.0)
    c.pair_all(stiffness=1.0, restitution=1.0)
    random = numpy.random.default_rng(1)
    for i, angle in enumerate(angles):
        axis = random.normal(size=3)
        axis *= angle / step / numpy.linalg.norm(axis)
        c.body("box", "m", (i, 0, 0), angular_velocity=axis)
        c.body("cube", "m", (i, 1, 0), angular_velocity=axis)
    run = report.run(c.run(tools))
    worst = numpy.abs((run.q**2).sum(axis=2) - 1).max()
    orthogonality = 0.0
    for q in run.q[-1]:
        R = numpy.stack([rotated(q, e) for e in numpy.eye(3)], axis=1)
        orthogonality = max(orthogonality, numpy.abs(R.T @ R - numpy.eye(3)).max())
    report.at_most("||q|^2 - 1|", worst, 4e-16 * math.sqrt(steps))
    report.at_most("|R^T R - 1|", orthogonality, 4e-16 * math.sqrt(steps))
    cube = run.q[-1, 1::2]
    exact = [quaternion(c.bodies[2 * i + 1]["angular_velocity"], angle * steps) if angle > 1e-100 else numpy.array([1., 0, 0, 0]) for i, angle in enumerate(angles)]
    report.at_most("a cube turns by |w| t [rad]", max(angle_between(a, b) for a, b in zip(cube, exact)), 1e-9)
