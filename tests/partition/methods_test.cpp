// The four ways to share bodies out, each with one part a rank, as the solver calls them.
#include <gtest/gtest.h>

#include <map>

#include "core/base/error.hpp"
#include "tests/partition/cloud.hpp"

namespace scree {
namespace {

using namespace test;

class Methods : public ::testing::TestWithParam<CutMethod> {
 protected:
  /// Part of every point of the cloud, demanded to be the same on every rank.
  static std::vector<int> parts_of(const Partitioner& partitioner, const Cloud& all) {
    std::vector<int> parts;
    for (std::size_t i = 0; i < all.points.size(); ++i) parts.push_back(partitioner.part_of(all.ids[i], all.points[i]));
    std::vector<int> first = parts;
    MPI_Bcast(first.data(), static_cast<int>(first.size()), MPI_INT, 0, MPI_COMM_WORLD);
    EXPECT_EQ(parts, first);
    return parts;
  }
  static double imbalance_of(const std::vector<int>& parts, const Cloud& all) {
    std::vector<double> work(static_cast<std::size_t>(rank_count()));
    for (std::size_t i = 0; i < parts.size(); ++i) work[static_cast<std::size_t>(parts[i])] += all.weights[i];
    return imbalance(work);
  }
};

TEST_P(Methods, share_the_work_evenly_and_all_ranks_agree_on_every_owner) {
  const Cloud all = clustered_cloud(4000), own = share(all);
  Partitioner partitioner(MPI_COMM_WORLD, rank_count(), GetParam());
  partitioner.cut(own.ids, own.points, own.weights);
  EXPECT_LT(imbalance_of(parts_of(partitioner, all), all), 1.02);  // as for boxes: one point of weight 4 in a share of 2000
}

TEST_P(Methods, cut_again_when_the_points_have_moved_and_stay_balanced) {
  Cloud all = clustered_cloud(4000);
  Partitioner partitioner(MPI_COMM_WORLD, rank_count(), GetParam());
  for (int round = 0; round < 4; ++round) {
    const Cloud own = share(all);
    partitioner.cut(own.ids, own.points, own.weights);
    EXPECT_LT(imbalance_of(parts_of(partitioner, all), all), 1.02) << "round " << round;
    for (Vec3& p : all.points) p = {p.x + 0.3 * p.z, p.y - 0.2 * p.x, 0.9 * p.z};  // a shear: other directions become longest
  }
}

TEST_P(Methods, leave_everybody_an_owner_when_a_rank_gives_nothing_or_one_body_outweighs_all) {
  Cloud all = clustered_cloud(500);
  all.weights[77] = 1e6;
  const Cloud own = share(all, rank_count() - 1);
  Partitioner partitioner(MPI_COMM_WORLD, rank_count(), GetParam());
  partitioner.cut(own.ids, own.points, own.weights);
  for (int part : parts_of(partitioner, all)) EXPECT_TRUE(part >= 0 && part < rank_count());
}

TEST_P(Methods, own_few_points_and_none) {
  Cloud all;
  all.ids = {4, 9, 11};
  all.points = {{0, 0, 0}, {1, 2, 0}, {1, 2, 5}};
  all.weights = {1, 1, 1};
  Partitioner partitioner(MPI_COMM_WORLD, rank_count(), GetParam());
  partitioner.cut({}, {}, {});
  for (int part : parts_of(partitioner, all)) EXPECT_TRUE(part >= 0 && part < rank_count());
  const Cloud own = share(all);
  partitioner.cut(own.ids, own.points, own.weights);
  std::map<int, int> counts;
  for (int part : parts_of(partitioner, all)) ++counts[part];
  EXPECT_EQ(counts.size(), static_cast<std::size_t>(std::min(rank_count(), 3)));
}

std::string name_of(const ::testing::TestParamInfo<CutMethod>& info) { return cut_method_name(info.param); }
INSTANTIATE_TEST_SUITE_P(Each, Methods, ::testing::Values(CutMethod::rcb, CutMethod::rib, CutMethod::hsfc, CutMethod::body), name_of);

TEST(CutMethod, names_read_back_and_an_unknown_one_is_refused) {
  for (const std::string& name : cut_method_names()) EXPECT_EQ(cut_method_name(cut_method_of(name)), name);
  EXPECT_THROW(cut_method_of("orb"), UsageError);
}

TEST(CutBoxes, are_within_reach_by_the_distance_of_their_nearest_corners) {
  CutBoxes boxes;
  boxes.lower = {{0, 0, 0}, {4, 5, 0}, {-1e300, -1e300, 3}};
  boxes.upper = {{1, 1, 1}, {6, 6, 1}, {1e300, 1e300, 1e300}};
  EXPECT_FALSE(boxes.are_within(0, 1, 5));  // 3-4-5
  EXPECT_TRUE(boxes.are_within(0, 1, 5.0001));
  EXPECT_TRUE(boxes.are_within(1, 0, 5.0001));
  EXPECT_FALSE(boxes.are_within(0, 2, 2));
  EXPECT_TRUE(boxes.are_within(1, 2, 2.1));
}

}  // namespace
}  // namespace scree
