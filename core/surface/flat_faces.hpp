// The flat faces, straight edges and corners of a mesh, and fields that are given at the corners alone.
//
// How finely a flat face or a straight edge is split must not matter to what is done with a shape. A field that is linear along edges and
// over faces with three corners has this property. Over other faces it is the mean value interpolation of what holds on their edges:
// weights above 0 that reproduce linear fields, and a map of a plane onto a convex one that folds nowhere; onto one that is not convex it
// may fold (face_outline.hpp). Source: mean value weights and why nothing folds: Floater, Computer Aided Geometric Design 20 (2003) 19,
// eq. 2.1.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "core/geometry/features.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/surface/face_outline.hpp"

namespace scree {

class FlatFaces {
 public:
  /// Cost: O(T log T), and a sparse factorisation for each face with vertices inside.
  explicit FlatFaces(const TriangleMesh& mesh);

  const std::vector<std::int32_t>& corners() const { return features_.corners; }  ///< vertices, ascending
  std::size_t face_count() const { return face_corners_.size(); }
  std::size_t face(std::int32_t triangle) const { return static_cast<std::size_t>(features_.region[static_cast<std::size_t>(triangle)]); }
  bool is_corner(std::int32_t vertex) const { return features_.corner_of[static_cast<std::size_t>(vertex)] >= 0; }
  /// Corners of the face that the triangle is part of, ascending.
  const std::vector<std::int32_t>& corners_of_face(std::int32_t triangle) const { return face_corners_[face(triangle)]; }
  /// Pairs of corners at the two ends of a straight edge, each once.
  const std::vector<std::array<std::int32_t, 2>>& edges() const { return edges_; }
  /// Corners of each face of other than three corners: what moves them apart makes the face uneven.
  const std::vector<std::vector<std::int32_t>>& rigid_faces() const { return rigid_faces_; }
  /// Of the rigid faces, in their order.
  const std::vector<FaceOutline>& outlines() const { return outlines_; }

  /// Sets `field` at all vertices that are no corners, from what it is at corners.
  void spread(std::vector<Vec3>& field) const;

 private:
  void find_outlines(const TriangleMesh& mesh);
  void find_edges(const TriangleMesh& mesh);
  void find_insides(const TriangleMesh& mesh);

  struct OnEdge {
    std::int32_t vertex, first, second;  ///< vertices; the last two are corners
    double share;                        ///< of the second
  };
  struct Inside;  // of one face

  FeatureTable features_;
  std::vector<std::vector<std::int32_t>> face_corners_, rigid_faces_;
  std::vector<FaceOutline> outlines_;
  std::vector<std::array<std::int32_t, 2>> edges_;
  std::vector<OnEdge> on_edges_;
  std::vector<std::shared_ptr<const Inside>> insides_;
};

}  // namespace scree
