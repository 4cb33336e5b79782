// Whether bodies touch in a point, along an edge or with a face, and how many of their degrees of freedom that takes.
#pragma once

#include <cstdint>
#include <vector>

#include "post/statistics/contact_measures.hpp"

namespace scree {

enum class ContactKind : std::uint8_t { point, edge, face };
const char* name_of(ContactKind kind);

/// The contact points of a pair that press in one direction: one contact.
struct SurfaceContact {
  std::int64_t body_a = 0, body_b = 0;  ///< as in the frame
  std::int32_t row_a = -1, row_b = -1;  ///< rows of the frame's bodies; -1: a wall
  ContactKind kind = ContactKind::point;
  std::int32_t points = 0;       ///< contact points
  double length = 0, width = 0;  ///< largest distance of two of the points; of a point from the line through these two [m]
  double normal_force = 0;       ///< sum over the points [N]; below 0 where they pull
  Vec3 point, normal;            ///< mean of the points [m]; unit, from b to a
};

/// Extent of a patch over the diameter of the smaller body (of equal volume) from which on it counts: 0.1.
///
/// Bodies of meshes touch in patches of finite size even where they are round: the patch of an overlap of a thousandth of the diameter is
/// 0.06 diameters wide. Faces of bodies are rarely smaller than a fifth of a diameter.
inline constexpr double kPatch = 0.1;

/// Contacts in the order of the frame. Contact points that carry a normal force count.
///
/// How: contact points of a pair whose normals lie within 25 degrees of that of the strongest point are one contact; what is left is
/// divided in the same way, so that a body in a corner of a box has three contacts with this wall. A contact is a face where the width of
/// its points is above kPatch, an edge where only their length is, else a point.
std::vector<SurfaceContact> surface_contacts(const FrameView& view);

/// Degrees of freedom that a contact takes from its two bodies together: with friction a point 3, an edge 5, a face 6; without friction
/// 1, 2, 3. Source: M. Neudecker, S. Ulrich, S. Herminghaus, M. Schroeter, Jammed frictional tetrahedra are hyperstatic, Phys. Rev. Lett.
/// 111 (2013) 028001.
double constraints_of(ContactKind kind, bool has_friction);

/// Of one particle.
struct BodyConstraints {
  std::int32_t point = 0, edge = 0, face = 0;  ///< contacts
  double with_friction = 0;                    ///< constraints: half of those of a contact with a particle, all of those of one with a wall
  double without_friction = 0;                 ///< constraints: all of those of every contact, as published for beds without friction
};
/// By row of the frame's bodies; zero for bodies that are no particles.
std::vector<BodyConstraints> body_constraints(const FrameView& view, const std::vector<SurfaceContact>& contacts);

/// Means over the particles of a group; NaN without particles.
struct ConstraintMeasures {
  double point = 0, edge = 0, face = 0;  ///< contacts per particle
  double with_friction = 0, without_friction = 0;
};
ConstraintMeasures constraint_measures(const FrameView& view, const Group& group, const std::vector<BodyConstraints>& bodies);

}  // namespace scree
