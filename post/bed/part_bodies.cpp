#include "post/bed/part_bodies.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/base/index.hpp"
#include "core/base/long_work.hpp"
#include "core/distance/mesh_distance.hpp"
#include "core/geometry/mass_properties.hpp"
#include "core/surface/self_intersections.hpp"
#include "post/bed/closed_cut.hpp"

namespace scree {

namespace {

using Index = std::int32_t;

constexpr double kEnough = 0.5;    // of a gap: pairs that are so far apart stay as they are, which saves half of all cuts
constexpr double kDeepest = 0.1;   // of a diameter: beds overlap by a hundredth or less; what is deeper is a hollow surface
constexpr double kOneFace = 0.98;  // cosine of 11 degrees: contact points of one face
// of a gap: no edge of a cap is shorter; a hundred times what single precision moves in a bed of a hundred diameters
constexpr double kSnap = 1e-2;
constexpr double kAside = 0.03;  // of a gap: by so much a plane moves that meets a vertex or a rim of several loops
constexpr double kTouch = 1e-3;  // of a gap: triangles that are so near are those that may cross
constexpr double kFlat = 1e-3;   // of a gap: lower triangles turn over in single precision
constexpr double kSlack = 0.1;   // of that: merged edges and single precision may bring surfaces nearer
constexpr int kTries = 4;
constexpr double kMuch = 0.02;              // of a body's volume, and two gaps: a plane that takes off more is not that of one contact
constexpr std::size_t kMostPoints = 20000;  // of a curve that is divided into pieces, which costs the square of their number at worst
constexpr double kMost = 0.33;              // of a body's volume: then the pair is left as it is
constexpr int kCrossingRounds = 10;         // of surfaces that cross: one or two are enough where each piece has a plane
constexpr int kRounds = 100;                // a ball in a hollow of twice its radius needs about ten

struct Solid {
  TriangleMesh mesh;
  Bvh bvh;
  Box3 box;
  double diameter = 0;
  double volume = 0;  ///< before all cuts [m^3]
  bool is_cut = false;
  MeshView view() const { return {&mesh, &bvh}; }
  void renew() {
    bvh = build_bvh(mesh);
    box = bounding_box(mesh);
  }
};

/// Where two surfaces are to be parted: the plane between them, and a point of each surface near it.
struct Between {
  Vec3 middle, normal;  ///< from b to a
  Vec3 point_a, point_b;
};

/// Points in which edges of one triangle pass through another.
void add_crossings(const std::array<Vec3, 3>& edges_of, const std::array<Vec3, 3>& t, std::vector<Vec3>& points) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &p = edges_of[k], &q = edges_of[(k + 1) % 3];
    const double hp = dot(p - t[0], n), hq = dot(q - t[0], n);
    if ((hp > 0) == (hq > 0)) continue;
    const Vec3 x = p + (hp / (hp - hq)) * (q - p);
    bool inside = true;
    for (std::size_t e = 0; e < 3 && inside; ++e) inside = dot(cross(t[(e + 1) % 3] - t[e], x - t[e]), n) >= 0;
    if (inside) points.push_back(x);
  }
}

class Parter {
 public:
  Parter(std::vector<TriangleMesh>& bodies, std::span<const double> diameters, const std::vector<TriangleMesh>& walls,
         const Periodicity& period, const std::vector<BedContact>& contacts, const PartingOptions& options)
      : bodies_(bodies), period_(period), options_(options), scratch_(make_mesh_distance_scratch()) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      solids_.push_back({bodies[i], {}, {}, diameters[i], mass_properties(bodies[i]).volume, false});
      solids_.back().renew();
    }
    for (const TriangleMesh& wall : walls) {
      walls_.push_back({wall, {}, {}, 0, 0, false});
      walls_.back().renew();
    }
    for (const BedContact& c : contacts) contacts_[{c.a, c.b}].push_back(c);
  }

  Parting run() {
    Parting result;
    const std::vector<Pair> pairs = pairs_that_may_meet();
    LongWork work("parting of bodies", static_cast<double>(2 * pairs.size()));
    std::vector<bool> near;
    for (const Pair& pair : pairs) {
      work.advance();
      near.push_back(distance(pair, kEnough * gap_of(pair)) < kEnough * gap_of(pair));
      if (near.back()) part(pair);
    }
    for (Solid& s : solids_) {
      if (s.is_cut) {
        collapse_short_edges(s.mesh, kSnap * options_.gap * s.diameter);
        flip_flat_triangles(s.mesh, kFlat * options_.gap * s.diameter);
      }
      round_to_single(s);
      if (s.is_cut) result.self_crossings += find_crossing_pairs(s.mesh).size();
    }
    result.smallest_gap = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      work.advance();
      const double gap = gap_of(pairs[k]), d = distance(pairs[k], 2 * gap);
      if (d < 2 * gap) result.smallest_gap = std::min(result.smallest_gap, d);
      if (d < kEnough * gap * (1 - kSlack))
        result.left.emplace_back(pairs[k].a, pairs[k].b);
      else if (near[k])
        ++result.parted;
    }
    for (std::size_t i = 0; i < solids_.size(); ++i) bodies_[i] = std::move(solids_[i].mesh);
    return result;
  }

 private:
  struct Pair {
    Index a, b;
    Vec3 shift;  ///< from b to the image of it that is near a [m]
  };

  const Solid& solid(Index b) const { return b >= 0 ? solids_[at(b)] : walls_[at(-1 - b)]; }
  double gap_of(const Pair& p) const {
    const double a = solids_[at(p.a)].diameter;
    return options_.gap * (p.b >= 0 ? std::min(a, solids_[at(p.b)].diameter) : a);
  }

  /// Boxes of bodies, a gap larger, that meet in any image; each pair and image once.
  std::vector<Pair> pairs_that_may_meet() const {
    struct Entry {
      Box3 box;
      Index body;
      Vec3 shift;
      bool is_image;
    };
    std::vector<Entry> entries;
    Box3 all;
    const auto grown = [&](const Solid& s) {
      const double g = options_.gap * s.diameter;
      return Box3{s.box.lower - Vec3{g, g, g}, s.box.upper + Vec3{g, g, g}};
    };
    for (const Solid& s : solids_) all.add(grown(s));
    const auto meet = [](const Box3& p, const Box3& q) {
      for (int k = 0; k < 3; ++k) {
        if (p.lower[k] > q.upper[k] || q.lower[k] > p.upper[k]) return false;
      }
      return true;
    };
    for (Index i = 0; i < static_cast<Index>(solids_.size()); ++i) {
      const Box3 box = grown(solids_[at(i)]);
      entries.push_back({box, i, {}, false});
      for_each_later_image([&](const Vec3& shift) {
        const Box3 image{box.lower + shift, box.upper + shift};
        if (meet(image, all)) entries.push_back({image, i, shift, true});
      });
    }
    std::sort(entries.begin(), entries.end(),
              [](const Entry& p, const Entry& q) { return std::pair(p.box.lower.x, p.body) < std::pair(q.box.lower.x, q.body); });
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      for (std::size_t j = i + 1; j < entries.size() && entries[j].box.lower.x <= entries[i].box.upper.x; ++j) {
        const Entry &p = entries[i], &q = entries[j];
        if ((p.is_image && q.is_image) || !meet(p.box, q.box) || p.body == q.body) continue;
        const Entry &own = p.is_image ? q : p, &other = p.is_image ? p : q;
        if (own.body < other.body)
          pairs.push_back({own.body, other.body, other.shift});
        else
          pairs.push_back({other.body, own.body, -other.shift});
      }
    }
    for (Index i = 0; i < static_cast<Index>(solids_.size()); ++i) {
      for (Index w = 0; w < static_cast<Index>(walls_.size()); ++w) {
        if (meet(grown(solids_[at(i)]), walls_[at(w)].box)) pairs.push_back({i, -1 - w, {}});
      }
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
    return pairs;
  }

  /// Half of the 26 neighbours of a cell: of a pair and its mirror image one is met.
  template <class Visit>
  void for_each_later_image(const Visit& visit) const {
    if (!period_.any()) return;
    const auto reach = [&](int k) { return period_.is_periodic(k) ? 1 : 0; };
    for (int x = -reach(0); x <= reach(0); ++x) {
      for (int y = -reach(1); y <= reach(1); ++y) {
        for (int z = -reach(2); z <= reach(2); ++z) {
          const bool later = x != 0 ? x > 0 : y != 0 ? y > 0 : z > 0;
          if (later) visit(period_.with_least_shear().shift({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)}));
        }
      }
    }
  }

  static Placement placed(const Vec3& shift) {
    Placement p;
    p.translation = shift;
    return p;
  }
  double distance(const Pair& pair, double upper, TrianglePair* nearest = nullptr) {
    return mesh_distance(solids_[at(pair.a)].view(), solid(pair.b).view(), placed(pair.shift), upper, *scratch_, nearest);
  }

  void part(const Pair& pair) {
    const double gap = gap_of(pair);
    int crossing_rounds = 0;
    for (int round = 0; round < kRounds; ++round) {
      TrianglePair nearest{-1, -1};
      const double d = distance(pair, gap, &nearest);
      if (d >= kEnough * gap) return;
      if (d == 0 && ++crossing_rounds > kCrossingRounds) return;
      if (has_lost(pair.a, kMost) || (pair.b >= 0 && has_lost(pair.b, kMost))) return;
      bool any = false;
      if (round == 0) {
        for (const Between& place : places_of_contacts(pair)) any = cut_both(pair, place, gap) || any;
      }
      if (!any) any = d > 0 ? cut_both(pair, between_nearest(pair, nearest), gap) : cut_crossing(pair, gap);
      if (!any) return;
    }
  }

  /// Contacts of one direction are one face, which surface_contacts() may have given as two: their mean.
  std::vector<Between> places_of_contacts(const Pair& pair) const {
    const auto found = contacts_.find({pair.a, pair.b});
    std::vector<Between> places;
    if (found == contacts_.end()) return places;
    std::vector<bool> used(found->second.size());
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i]) continue;
      Vec3 point, normal;
      double count = 0;
      for (std::size_t j = i; j < used.size(); ++j) {
        const BedContact& c = found->second[j];
        // a point of b across a periodic side is given near b or near a: the image near a is meant
        if (used[j] || dot(c.normal, found->second[i].normal) < kOneFace) continue;
        used[j] = true;
        point += near_a(pair, c.point);
        normal += c.normal;
        count += 1;
      }
      point *= 1 / count;
      places.push_back({point, normalised(normal), point, point});
    }
    return places;
  }
  Vec3 near_a(const Pair& pair, const Vec3& p) const {
    if (!period_.any()) return p;
    const Vec3 centre = solids_[at(pair.a)].box.centre();
    return centre + period_.with_least_shear().nearest(p - centre);
  }

  std::array<Vec3, 3> corners(const TriangleMesh& mesh, Index t, const Vec3& shift) const {
    return {mesh.corner(t, 0) + shift, mesh.corner(t, 1) + shift, mesh.corner(t, 2) + shift};
  }

  Between between_nearest(const Pair& pair, const TrianglePair& nearest) const {
    const std::array<Vec3, 3> a = corners(solids_[at(pair.a)].mesh, nearest.a, {}), b = corners(solid(pair.b).mesh, nearest.b, pair.shift);
    const TriangleDistance d = triangle_distance(a.data(), b.data());
    return {0.5 * (d.point_a + d.point_b), d.normal, d.point_a, d.point_b};
  }

  /// A point in which the surfaces cross, and the direction from b to a there: the mean of the normals of both.
  struct Crossing {
    Vec3 point, normal;
  };
  std::vector<Crossing> crossings_of(const Pair& pair) {
    const Solid &a = solids_[at(pair.a)], &b = solid(pair.b);
    std::vector<TrianglePair> crossing;
    triangle_pairs_within(a.view(), b.view(), placed(pair.shift), kTouch * gap_of(pair), *scratch_, crossing);
    std::vector<Crossing> found;
    std::vector<Vec3> points;
    const auto normal_of = [](const std::array<Vec3, 3>& t) { return cross(t[1] - t[0], t[2] - t[0]); };
    for (const TrianglePair& t : crossing) {
      const std::array<Vec3, 3> ta = corners(a.mesh, t.a, {}), tb = corners(b.mesh, t.b, pair.shift);
      points.clear();
      add_crossings(ta, tb, points);
      add_crossings(tb, ta, points);
      // a wall may face away: a surface that is not closed says nothing of its side
      const Vec3 normal = (pair.b >= 0 ? normalised(normal_of(tb)) : Vec3{}) - normalised(normal_of(ta));
      for (const Vec3& p : points) found.push_back({p, normal});
    }
    return found;
  }

  /// The plane fitted to the curve in which the surfaces cross. A curve that is a line has no plane: then the one across the mean normal.
  static Between fitted(const std::vector<Crossing>& curve) {
    Vec3 middle, mean;
    for (const Crossing& c : curve) middle += (1.0 / static_cast<double>(curve.size())) * c.point, mean += c.normal;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Crossing& c : curve) {
      const Eigen::Vector3d r(c.point.x - middle.x, c.point.y - middle.y, c.point.z - middle.z);
      spread += r * r.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    const auto column = [&](int k) { return Vec3{solver.eigenvectors()(0, k), solver.eigenvectors()(1, k), solver.eigenvectors()(2, k)}; };
    constexpr double kLine = 1e-6;
    Vec3 normal = column(0);
    if (!(solver.eigenvalues()[1] > kLine * solver.eigenvalues()[2])) normal = mean - dot(mean, column(2)) * column(2);
    if (!(length(normal) > 0)) normal = mean;
    normal = normalised(normal);
    if (dot(normal, mean) < 0) normal = -normal;
    return {middle, normal, middle, middle};
  }

  /// Cuts where the surfaces cross: at the plane of the whole curve, as of convex bodies, or else piece by piece.
  bool cut_crossing(const Pair& pair, double gap) {
    const std::vector<Crossing> curve = crossings_of(pair);
    if (curve.empty()) return false;
    // a copy of both: one plane through several places of contact would take off what lies between them
    const Solid a = solids_[at(pair.a)], b = pair.b >= 0 ? solids_[at(pair.b)] : Solid{};
    if (cut_both(pair, fitted(curve), gap)) {
      const bool much =
          lost_since(pair.a, a) > kMuch + 2 * options_.gap || (pair.b >= 0 && lost_since(pair.b, b) > kMuch + 2 * options_.gap);
      if (!much || curve.size() > kMostPoints) return true;
      solids_[at(pair.a)] = a;
      if (pair.b >= 0) solids_[at(pair.b)] = b;
    }
    const double reach = kDeepest * gap / options_.gap;  // gap over options_.gap: the smaller diameter
    std::vector<bool> used(curve.size());
    bool any = false;
    for (std::size_t i = 0; i < curve.size(); ++i) {
      if (used[i]) continue;
      std::vector<Crossing> piece;
      for (std::size_t j = i; j < curve.size(); ++j) {
        if (used[j] || length(curve[j].point - curve[i].point) > reach) continue;
        used[j] = true;
        piece.push_back(curve[j]);
      }
      const Between across = fitted(piece);
      Vec3 mean;
      for (const Crossing& c : piece) mean += c.normal;
      std::vector<Between> planes{across};
      if (length(mean) > 0) planes.push_back({across.middle, normalised(mean), across.middle, across.middle});
      any = cut_the_least(pair, planes, gap) || any;
    }
    return any;
  }

  /// Cuts at that one of the planes that takes off least; false where none cuts.
  bool cut_the_least(const Pair& pair, const std::vector<Between>& planes, double gap) {
    const Solid a = solids_[at(pair.a)], b = pair.b >= 0 ? solids_[at(pair.b)] : Solid{};
    Solid best_a, best_b;
    double least = std::numeric_limits<double>::infinity();
    for (const Between& plane : planes) {
      const bool is_cut = cut_both(pair, plane, gap);
      const double lost = lost_since(pair.a, a) + (pair.b >= 0 ? lost_since(pair.b, b) : 0);
      if (is_cut && lost < least) {
        least = lost;
        best_a = solids_[at(pair.a)];
        if (pair.b >= 0) best_b = solids_[at(pair.b)];
      }
      solids_[at(pair.a)] = a;
      if (pair.b >= 0) solids_[at(pair.b)] = b;
    }
    if (!std::isfinite(least)) return false;
    solids_[at(pair.a)] = std::move(best_a);
    if (pair.b >= 0) solids_[at(pair.b)] = std::move(best_b);
    return true;
  }

  double volume_of(const Solid& s) const { return mass_properties(s.mesh).volume; }
  /// Share of its first volume that a body has lost since a copy of it was made.
  double lost_since(Index body, const Solid& copy) const { return (volume_of(copy) - volume_of(solids_[at(body)])) / copy.volume; }
  bool has_lost(Index body, double share) const {
    const Solid& s = solids_[at(body)];
    return s.is_cut && volume_of(s) < (1 - share) * s.volume;
  }

  bool cut_both(const Pair& pair, const Between& place, double gap) {
    if (pair.b < 0) return cut(pair.a, place.point_b + gap * place.normal, -place.normal, gap) == CutOutcome::cut;
    const CutOutcome a = cut(pair.a, place.middle + 0.5 * gap * place.normal, -place.normal, gap);
    const CutOutcome b = cut(pair.b, place.middle - 0.5 * gap * place.normal - pair.shift, place.normal, gap);
    const auto stays = [](CutOutcome o) { return o == CutOutcome::deep || o == CutOutcome::refused; };
    bool any = a == CutOutcome::cut || b == CutOutcome::cut;
    if (stays(a) && !stays(b))
      any = cut(pair.b, place.point_a - gap * place.normal - pair.shift, place.normal, gap) == CutOutcome::cut || any;
    if (stays(b) && !stays(a)) any = cut(pair.a, place.point_b + gap * place.normal, -place.normal, gap) == CutOutcome::cut || any;
    return any;
  }

  CutOutcome cut(Index body, const Vec3& plane, const Vec3& normal, double gap) {
    Solid& s = solids_[at(body)];
    CutOutcome outcome = CutOutcome::refused;
    for (int k = 0; k < kTries && outcome == CutOutcome::refused; ++k) {
      outcome = cut_off(s.mesh, plane - (k * kAside * gap) * normal, normal, plane, kDeepest * s.diameter + gap, kSnap * gap);
    }
    if (outcome == CutOutcome::cut) {
      s.is_cut = true;
      s.renew();
    }
    return outcome;
  }

  /// Vertices that become one in single precision are one, and triangles without area go.
  static void round_to_single(Solid& s) {
    std::map<std::array<float, 3>, Index> named;
    std::vector<Index> place;
    std::vector<Vec3> vertices;
    for (const Vec3& p : s.mesh.vertices) {
      const std::array<float, 3> single{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
      const auto [it, is_new] = named.try_emplace(single, static_cast<Index>(vertices.size()));
      if (is_new) vertices.push_back({single[0], single[1], single[2]});
      place.push_back(it->second);
    }
    std::vector<Triangle> triangles;
    for (const Triangle& t : s.mesh.triangles) {
      const Triangle r{place[at(t[0])], place[at(t[1])], place[at(t[2])]};
      if (r[0] != r[1] && r[1] != r[2] && r[2] != r[0]) triangles.push_back(r);
    }
    s.mesh = {std::move(vertices), std::move(triangles)};
    s.renew();
  }

  std::vector<TriangleMesh>& bodies_;
  Periodicity period_;
  PartingOptions options_;
  std::vector<Solid> solids_, walls_;
  std::map<std::pair<Index, Index>, std::vector<BedContact>> contacts_;
  MeshDistanceScratchPtr scratch_;
};

}  // namespace

Parting part_bodies(std::vector<TriangleMesh>& bodies, std::span<const double> diameters, const std::vector<TriangleMesh>& walls,
                    const Periodicity& period, const std::vector<BedContact>& contacts, const PartingOptions& options) {
  return Parter(bodies, diameters, walls, period, contacts, options).run();
}

}  // namespace scree
