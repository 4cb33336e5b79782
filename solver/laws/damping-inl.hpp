// What damping does to the push of a contact in a step (laws/damping.hpp), for one pair or for a pair in each lane: see laws/real.hpp.

/// chi of viscous damping [s/m].   in   doubled_ratio   2 zeta     in   energy   of the push [J]     in   mobility   [1/kg]
SCREE_LAW Real viscous_chi(Real doubled_ratio, Real energy, Real mobility) { return doubled_ratio / sqrt(Real(2.0) * energy * mobility); }

/// What chi is divided by, so that damping by the velocity of half a step before takes what it should.   in   rate   r dt
SCREE_LAW Real lag_of(Real rate) { return Real(1.0) + Real(0.25) * rate; }

/// Largest weight of damping in the step of touch, with which it does not turn the motion round.   in   lagged   lag_of(rate)
SCREE_LAW Real most_onset_of(Real rate, Real lagged, Real max_onset) {
  const Real one(1.0), onset = lagged / rate;
  return select(rate > Real(0.0), select(onset < one, one, select(max_onset < onset, max_onset, onset)), one);
}

/// Share of a step that the push of a contact stands for.   in   closing   way by which the surfaces close in a step [m]
SCREE_LAW Real onset_weight(Real overlap, Real closing) { return select(overlap < closing, overlap / closing + Real(0.5), Real(1.0)); }

/// The push with its damping [N].   in   weight   of the damping     in   vn   at which the surfaces part [m/s]
/// in   least   of the push, below which damping does not go
SCREE_LAW Real damped_push(Real push, Real chi, Real weight, Real vn, Real least) {
  const Real share = Real(1.0) - chi * weight * vn;
  return push * select(least < share, share, least);
}
