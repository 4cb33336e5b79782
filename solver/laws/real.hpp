// What the laws that are written once are written in: Real, Real3, RealQuat, Truth. A text of such a law, X-inl.hpp, is no header of its
// own. It is included inside a namespace that says what these words stand for:
//   - one pair (namespace scree, by X.hpp): double, Vec3, Quat, bool, as declared here;
//   - a pair in each lane (scree::HWY_NAMESPACE, by lanes/lane_contact-inl.hpp, once for every instruction set): Lane, Lane3, ...
// The operations and their order are the same, none is fused, so that both widths have the same bits.
//
// A choice is select(truth, yes, no); both sides are computed in lanes, so that the side not taken may divide by 0. What costs a root or a
// quotient and concerns few contacts stands behind `if (any(truth))`: those that it does not concern keep their bits, whether or not
// another lane is concerned.
#pragma once

#include <cmath>

#include "core/geometry/vec3.hpp"

namespace scree {

using Real = double;
using Real3 = Vec3;
using RealQuat = Quat;
using Truth = bool;

inline Real select(Truth truth, Real yes, Real no) { return truth ? yes : no; }
inline Real3 select(Truth truth, const Real3& yes, const Real3& no) { return truth ? yes : no; }
inline bool any(Truth truth) { return truth; }
inline Truth equal(const RealQuat& a, const RealQuat& b) { return a == b; }
inline Real abs(Real x) { return std::abs(x); }
inline Real sqrt(Real x) { return std::sqrt(x); }

}  // namespace scree
