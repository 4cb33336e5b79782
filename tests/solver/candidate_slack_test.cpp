// Candidates that wait (solver/features/candidate_slack.hpp) change nothing: lists that are kept while two bodies move about each other
// give in every step the features of lists made in that step, to the bit.
#include "solver/features/candidate_slack.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "tests/solver/two_bodies.hpp"

namespace scree {
namespace {

using namespace test;

struct Counts {
  int features = 0, edges = 0, renewed = 0, quiet = 0;
};

/// Bit for bit, but for what a constructor may leave unset.
bool same(const ContactFeature& l, const ContactFeature& r) {
  return l.key == r.key && l.x == r.x && l.n == r.n && l.overlap == r.overlap && l.weight == r.weight && l.cluster == r.cluster &&
         l.faded == r.faded && l.weight_gradient.force == r.weight_gradient.force && l.weight_gradient.couple == r.weight_gradient.couple;
}

/// Lists that are kept while two bodies move, against lists of the same step.
class Comparison {
 public:
  Comparison(TwoBodies& pair, double margin, double skin) : pair_(pair), margin_(margin), skin_(skin) {}
  void forget_lists() { kept_ = {}; }
  const std::vector<ContactFeature>& features() const { return features_; }

  void look(int step, Counts& counts) {
    PairBody &a = pair_.body[0], &b = pair_.body[1];
    const double size = std::min(pair_.radius(0), pair_.radius(1));
    const RelativePose pose(a, b);
    if (kept_.skin < 0 || follow_motion(kept_, pose, pair_.radius(0), pair_.radius(1)) > kept_.skin) {
      ASSERT_TRUE(list(kept_));
      ++counts.renewed;
    }
    const double way = kept_.way;
    mesh_pair_features(a, b, pose, margin_, kSharingOfVertices * margin_, size, kept_, features_);
    CandidateLists fresh;
    ASSERT_TRUE(list(fresh));
    mesh_pair_features(a, b, pose, margin_, kSharingOfVertices * margin_, size, fresh, expected_);
    ASSERT_EQ(features_.size(), expected_.size()) << "step " << step;
    for (std::size_t j = 0; j < features_.size(); ++j) {
      ASSERT_TRUE(same(features_[j], expected_[j])) << "step " << step << ", feature " << j;
      counts.edges += indices_of_key(features_[j].key).kind == kEdgeEdge ? 1 : 0;
    }
    counts.features += static_cast<int>(features_.size());
    if (features_.empty() && kept_.next_examination > way) ++counts.quiet;
  }

 private:
  bool list(CandidateLists& lists) {
    return list_mesh_pair(pair_.body[0], pair_.body[1], margin_, kSharingOfVertices * margin_, skin_, pair_.radius(0), pair_.radius(1),
                          *scratch_, lists);
  }

  TwoBodies& pair_;
  double margin_, skin_;
  MeshDistanceScratchPtr scratch_ = make_mesh_distance_scratch();
  CandidateLists kept_;
  std::vector<ContactFeature> features_, expected_;
};

/// Lets A wander about where it touches B, by steps of about `stride`, and compares.
void wander(TwoBodies& pair, double margin, double skin, double stride, int steps, std::mt19937& g, Counts& counts) {
  std::normal_distribution<double> n;
  PairBody &a = pair.body[0], &b = pair.body[1];
  const double size = std::min(pair.radius(0), pair.radius(1));
  Comparison comparison(pair, margin, skin);
  Vec3 drift, turn;
  for (int step = 0; step < steps; ++step) {
    ASSERT_NO_FATAL_FAILURE(comparison.look(step, counts));
    const std::vector<ContactFeature>& features = comparison.features();
    // a smooth way, pulled back to where the two touch and pushed away from deep overlap
    double deepest = 0;
    Vec3 out;
    for (const ContactFeature& f : features) {
      deepest = std::max(deepest, f.overlap);
      out += f.overlap * rotate(a.q, f.n);
    }
    const Vec3 apart = a.x - b.x;
    drift = 0.9 * drift + (0.3 * stride) * Vec3{n(g), n(g), n(g)};
    if (deepest > 0.3 * margin) drift += (2 * stride / length(out)) * out;
    if (features.empty()) drift -= (0.2 * stride / length(apart)) * apart;
    turn = 0.9 * turn + (0.3 * stride / size) * Vec3{n(g), n(g), n(g)};
    a.x += drift;
    if (const double angle = length(turn); angle > 0) a.q = normalised(quaternion_of((1 / angle) * turn, angle) * a.q);
    if (deepest > 0.7 * margin) {  // too deep: away, and new lists
      a.x += (margin / length(out)) * out;
      drift = {};
      comparison.forget_lists();
    }
  }
}

void wander_from_touch(const TriangleMesh& a, const TriangleMesh& b, double skin, double stride, unsigned seed, int steps, Counts& counts) {
  std::mt19937 g(seed);
  TwoBodies pair(a, b, kStiffness, kMargin, 1, 0);
  place_at_random(pair, g);
  if (!pair.approach(2.2)) return;
  wander(pair, kMargin, skin, stride, steps, g, counts);
}

TEST(CandidateSlack, of_rocks_that_wander_about_each_other) {
  Counts counts;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    for (const double stride : {1e-5, 2e-4, 2e-3})
      wander_from_touch(scaled(rock(seed, 2), .5), scaled(rock(seed + 10, 2), .5), .02, stride, seed, 300, counts);
  }
  EXPECT_GT(counts.features, 5000);
  EXPECT_GT(counts.edges, 1000);
  EXPECT_GT(counts.renewed, 50);
  EXPECT_GT(counts.quiet, 50);
}

TEST(CandidateSlack, of_bodies_with_flat_faces_parallel_edges_and_thin_wedges) {
  Counts counts;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    for (const double stride : {2e-4, 2e-3}) {
      wander_from_touch(grid_box(1, {1, .2, .2}), grid_box(2, {1, .6, .4}), .02, stride, seed, 300, counts);
      wander_from_touch(rock(seed, 0), scaled(rock(seed + 3, 1), .3), .02, stride, seed, 300, counts);
    }
  }
  EXPECT_GT(counts.features, 3000);
  EXPECT_GT(counts.edges, 500);
}

TEST(CandidateSlack, of_a_small_body_on_a_large_one) {
  Counts counts;
  for (unsigned seed = 1; seed <= 4; ++seed)
    wander_from_touch(scaled(rock(seed, 2), .15), rock(seed + 5, 3), .015, 5e-4, seed, 300, counts);
  EXPECT_GT(counts.features, 500);
}

/// A cube of side 1 with a pyramid pressed into each of its faces.
TriangleMesh dented_cube(double depth) {
  TriangleMesh mesh = grid_box(1, {1, 1, 1});
  std::vector<Triangle> dents;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 2) {  // two in a row are a face, joined over the middle of their common edge
    const Triangle first = mesh.triangles[t], second = mesh.triangles[t + 1];
    std::vector<std::int32_t> rim(first.begin(), first.end());
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::find(first.begin(), first.end(), second[k]) != first.end()) continue;
      const std::int32_t after = second[(k + 1) % 3];  // the rim goes on there, and so the vertex comes before it
      rim.insert(std::find(rim.begin(), rim.end(), after), second[k]);
    }
    Vec3 middle;
    for (const std::int32_t v : rim) middle += 0.25 * mesh.vertices[static_cast<std::size_t>(v)];
    for (std::size_t k = 0; k < 4; ++k) dents.push_back({rim[k], rim[(k + 1) % 4], mesh.vertex_count()});
    mesh.vertices.push_back((1 - 2 * depth) * middle);
  }
  mesh.triangles = dents;
  return mesh;
}

/// Lets A come nearer to B from a skin away, straight and at a slant, until it is deep in touch, and compares.
/// in   slant   way along the surface over way towards it
void come_nearer(const TriangleMesh& a, const TriangleMesh& b, double margin, double skin, double stride, double slant, unsigned seed,
                 Counts& counts) {
  std::mt19937 g(seed);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  TwoBodies pair(a, b, kStiffness, margin, 1, 0);
  place_at_random(pair, g);
  if (!pair.approach(2.2, 0)) return;
  const double along = angle(g);
  const Vec3 way{slant * std::cos(along), slant * std::sin(along), -1};
  pair.body[0].x -= skin * way;
  Comparison comparison(pair, margin, skin);
  for (int step = 0; step * stride < 2 * skin; ++step) {
    ASSERT_NO_FATAL_FAILURE(comparison.look(step, counts));
    for (const ContactFeature& f : comparison.features())
      if (f.overlap > 0.5 * margin) return;
    pair.body[0].x += stride * way;
  }
}

// A corner that comes into a dent has several faces within reach when it begins to touch. One of them, looked at while the others waited,
// was held for the nearest: it then waited for longer than until the touch, and the minima were those of the other faces.
TEST(CandidateSlack, of_corners_that_come_into_dents) {
  Counts counts;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const TriangleMesh dented = dented_cube(.05 + .003 * seed);
    for (const double slant : {.3, 2.}) {
      come_nearer(scaled(rock(seed, 0), .2), dented, .15, .1, 1e-3, slant, seed, counts);
      come_nearer(scaled(dented, .6), subdivide(dented, false), .15, .1, 1e-3, slant, seed, counts);
    }
  }
  EXPECT_GT(counts.features, 5000);
  EXPECT_GT(counts.renewed, 50);
}

}  // namespace
}  // namespace scree
