// The friction spring of a contact, from one step to the next, for one contact or for one of each pair in a lane: see laws/real.hpp.
// Source: docs/reference/contact-law.md section 3.4.

/// What turns springs with both bodies (contact/transport.hpp).
struct HalfTurn {
  Real3 u;
  Real w;
};

/// Half of the turn between two poses of B against A; at rest, to the last bit, none.
SCREE_LAW HalfTurn half_turn(const RealQuat& before, const RealQuat& now) {
  const Real zero(0.0), half(0.5), one(1.0);
  const Truth at_rest = equal(before, now);
  const RealQuat by = now * conjugate(before);
  const Truth is_other = by.w < zero;
  const Real w = sqrt(half * (one + select(is_other, -by.w, by.w)));
  const Real3 axis{by.x, by.y, by.z};
  return {select(at_rest, Real3{zero, zero, zero}, (half / w) * select(is_other, -axis, axis)), select(at_rest, one, w)};
}

SCREE_LAW Real3 turned_by(const HalfTurn& turn, const Real3& s) {
  const Real3 t = cross(Real(2.0) * turn.u, s);
  return s + turn.w * t + cross(turn.u, t);
}

/// Takes a spring along from a contact's normal n to its present one m, by the shortest rotation: its length stays, whatever the angle.
/// Of a spring that keeps no normal the part along m goes.
SCREE_LAW Real3 transported(const Real3& spring, const Real3& n, const Real3& m) {
  const Real zero(0.0), c = Real(1.0) + dot(n, m);
  return select(c > Real(kOppositeNormal), spring - (dot(spring, m) / c) * (n + m), Real3{zero, zero, zero});
}

/// A contact as its spring sees it, in the frame of A.
struct SlidingContact {
  Real3 n;                           ///< from B to A, unit
  Real3 vt;                          ///< at which the surfaces slide [m/s]
  Real vn;                           ///< at which they part [m/s]
  Real overlap;                      ///< [m]
  Real stiffness;                    ///< kappa that the present push gives [N/m]
  Real damping;                      ///< of sliding [N s/m]
  Real sticking_limit, slide_limit;  ///< static and sliding coefficient times the push, damping included [N]
};

/// The spring of a contact.
struct ContactSpring {
  Real3 force;     ///< [N]
  Real stiffness;  ///< kappa [N/m]; below 0: -kappa of a contact that slides
};

/// The next spring, and the tangential force on A [N].
///
/// in   kept      whether there is a spring from the step before     in   carried   that spring, taken along to the present normal [N]
/// in   rounding  change of the stiffness times overlap that is none, as a share of the stiffness [m]
/// in   step      by which the spring moves [s]; 0 leaves it as it is
/// inout spring   its stiffness is that of the step before; `force` is not read
/// out  stretched  length of the spring before it yielded, squared [N^2]
SCREE_LAW Real3 friction_force(const SlidingContact& c, Truth kept, const Real3& carried, Real rounding, Real step, ContactSpring& spring,
                               Real& stretched) {
  const Real zero(0.0), one(1.0), before = abs(spring.stiffness);
  // Unloading gives force back in proportion; loading must not create any (passivity). A load that only rounding moves up and down is
  // neither (docs/develop/decisions/012): springs would lose a little each time, and a stiff heap would creep indefinitely.
  const Truth same = abs(c.stiffness - before) * c.overlap <= rounding * before;
  const Real kappa = select(kept & same, before, c.stiffness);
  Real3 next = carried;
  if (const Truth unloads = kappa < before; any(unloads)) next = select(unloads, kappa / before, one) * next;
  next = next - (kappa * step) * c.vt;
  if (any(!kept)) {  // one that touches since has slid only since then; one that has not yet has no stiffness
    const Real since = select((c.overlap > zero) & (c.overlap < (-c.vn) * step), c.overlap / (-c.vn), step);
    next = select(kept, next, ((-kappa) * since) * c.vt);
  }
  // a contact that slides sticks again once it no longer moves against its spring
  const Truth slid = kept & (spring.stiffness < zero) & (dot(next, c.vt) < zero);
  const Real limit = select(slid, c.slide_limit, c.sticking_limit);
  stretched = dot(next, next);
  const Truth yields = stretched > limit * limit, slides = slid | yields;
  if (any(yields)) next = select(yields, c.slide_limit / sqrt(stretched), one) * next;
  Real3 tangential = next - c.damping * c.vt;
  const Real total = dot(tangential, tangential), cap = select(slides, c.slide_limit, limit);
  if (const Truth is_above = total > cap * cap; any(is_above)) tangential = select(is_above, cap / sqrt(total), one) * tangential;
  spring = {next, select(slides, -kappa, kappa)};
  return tangential;
}

/// What a spring stores, added to `stored` [J].
SCREE_LAW Real with_energy(const ContactSpring& spring, Real stored) {
  const Real kappa = abs(spring.stiffness);
  return select(kappa > Real(0.0), stored + Real(0.5) * dot(spring.force, spring.force) / kappa, stored);
}
