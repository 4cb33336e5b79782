#include "core/partition/partition.hpp"

#include <zoltan.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "core/base/error.hpp"

namespace scree {

namespace {

constexpr double kOuter = 1e300;  // stands for infinity: finite, so that JSON and HDF5 tools show it

// Below this many points a part the points are gathered and cut here (see gather_and_cut): a few bodies cost
// less to move than to keep, so nothing is lost when cut directions change between calls.
constexpr std::int64_t kFewPointsPerPart = 8;

// Zoltan's ids are 32-bit in Debian's build; a 64-bit id travels as two entries.
static_assert(2 * sizeof(ZOLTAN_ID_TYPE) == sizeof(std::int64_t), "an id must fit two entries of ZOLTAN_ID_TYPE");

/// What Zoltan's callbacks read.
struct Points {
  std::span<const std::int64_t> ids;
  std::span<const Vec3> points;
  std::span<const double> weights;
};

int object_count(void* data, int* error) {
  *error = ZOLTAN_OK;
  return static_cast<int>(static_cast<const Points*>(data)->points.size());
}

void object_list(void* data, int global_entries, int local_entries, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int weight_count,
                 float* weights, int* error) {
  const Points& p = *static_cast<const Points*>(data);
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    std::memcpy(global + static_cast<std::size_t>(global_entries) * i, &p.ids[i], sizeof(std::int64_t));
    local[static_cast<std::size_t>(local_entries) * i] = static_cast<ZOLTAN_ID_TYPE>(i);
    if (weight_count > 0) weights[i] = static_cast<float>(p.weights[i]);
  }
  *error = ZOLTAN_OK;
}

int dimension_count(void* /*data*/, int* error) {
  *error = ZOLTAN_OK;
  return 3;
}

void coordinates(void* data, int /*global_entries*/, int local_entries, int count, ZOLTAN_ID_PTR /*global*/, ZOLTAN_ID_PTR local,
                 int dimension, double* values, int* error) {
  const Points& p = *static_cast<const Points*>(data);
  for (int i = 0; i < count; ++i) {
    const Vec3& x = p.points[local[static_cast<std::ptrdiff_t>(local_entries) * i]];
    for (int k = 0; k < 3; ++k) values[static_cast<std::ptrdiff_t>(dimension) * i + k] = x[k];
  }
  *error = ZOLTAN_OK;
}

/// Zoltan gives a point on a cut to the lower side, we give it to the upper one: the cut moves up by one bit.
double cut_side(double value) {
  if (!(value > -kOuter)) return -kOuter;
  if (!(value < kOuter)) return kOuter;
  return std::nextafter(value, kOuter);
}

/// Orders the leaves of a bisection from lower to upper side, cut by cut from the root. Zoltan's own order
/// depends on which process it sent a half to; sorting by corners would swap boxes whenever two cuts of
/// different halves pass each other, and so move all their bodies.
void order_by_cuts(const CutBoxes& boxes, std::vector<std::size_t>& parts, std::size_t first, std::size_t last) {
  const std::size_t count = last - first;
  if (count < 2) return;
  const auto at = [&](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
  std::size_t best_left = 0;
  int best_axis = -1;
  double best_cut = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t c = first; c < last; ++c) {
      const double cut = boxes.lower[parts[c]][axis];
      std::size_t left = 0;
      bool clean = true;
      for (std::size_t i = first; i < last && clean; ++i) {
        if (boxes.upper[parts[i]][axis] <= cut) ++left;
        else clean = boxes.lower[parts[i]][axis] >= cut;
      }
      if (!clean || left == 0 || left == count) continue;
      const auto uneven = [&](std::size_t n) { return n > count - n ? 2 * n - count : count - 2 * n; };
      if (best_axis < 0 || uneven(left) < uneven(best_left)) {
        best_left = left;
        best_axis = axis;
        best_cut = cut;
      }
    }
  }
  const auto begin = parts.begin() + at(first), end = parts.begin() + at(last);
  if (best_axis < 0) {
    // only boxes without points, all at one place: any order will do, as long as it is always the same
    std::sort(begin, end, [&](std::size_t a, std::size_t b) {
      for (int k = 0; k < 3; ++k) {
        if (boxes.lower[a][k] != boxes.lower[b][k]) return boxes.lower[a][k] < boxes.lower[b][k];
        if (boxes.upper[a][k] != boxes.upper[b][k]) return boxes.upper[a][k] < boxes.upper[b][k];
      }
      return false;
    });
    return;
  }
  std::stable_partition(begin, end, [&](std::size_t i) { return boxes.upper[i][best_axis] <= best_cut; });
  order_by_cuts(boxes, parts, first, first + best_left);
  order_by_cuts(boxes, parts, first + best_left, last);
}

/// Whether the leaves share no volume. A part without points comes back from Zoltan as a box over its neighbours.
bool is_tiling(const CutBoxes& boxes) {
  for (std::size_t a = 0; a < boxes.lower.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      bool overlap = true;
      for (int k = 0; k < 3; ++k) {
        overlap = overlap && std::max(boxes.lower[a][k], boxes.lower[b][k]) < std::min(boxes.upper[a][k], boxes.upper[b][k]);
      }
      if (overlap) return false;
    }
  }
  return true;
}

/// Everything to the first part: what a bisection of nothing is.
CutBoxes whole_space_first(int parts) {
  CutBoxes boxes;
  boxes.lower.assign(static_cast<std::size_t>(parts), Vec3{kOuter, -kOuter, -kOuter});
  boxes.upper.assign(static_cast<std::size_t>(parts), Vec3{kOuter, kOuter, kOuter});
  boxes.lower[0].x = -kOuter;
  return boxes;
}

struct WeightedPoint {
  Vec3 x;
  double weight;
  std::int64_t id;
};

/// Bisection of a handful of points, appended part by part; a part without points gets an empty box.
void cut_few(std::span<WeightedPoint> points, int parts, const Vec3& lower, const Vec3& upper, CutBoxes& boxes) {
  if (parts == 1) {
    boxes.lower.push_back(lower);
    boxes.upper.push_back(upper);
    return;
  }
  Vec3 low = upper, high = lower;
  double total = 0;
  for (const WeightedPoint& p : points) {
    low = component_min(low, p.x);
    high = component_max(high, p.x);
    total += p.weight;
  }
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  }
  std::sort(points.begin(), points.end(), [axis](const WeightedPoint& a, const WeightedPoint& b) {
    return a.x[axis] != b.x[axis] ? a.x[axis] < b.x[axis] : a.id < b.id;
  });
  const int left_parts = (parts + 1) / 2;
  // the split between two different coordinates that comes closest to the wanted share of the work
  const double wanted = total * left_parts / parts;
  double cut = upper[axis], sum = 0, best_error = std::numeric_limits<double>::max();
  std::size_t left_count = points.size();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    sum += points[i].weight;
    if (points[i].x[axis] < points[i + 1].x[axis] && std::abs(sum - wanted) < best_error) {
      best_error = std::abs(sum - wanted);
      left_count = i + 1;
      const double middle = 0.5 * (points[i].x[axis] + points[i + 1].x[axis]);
      cut = middle > points[i].x[axis] ? middle : points[i + 1].x[axis];
    }
  }
  Vec3 left_upper = upper, right_lower = lower;
  left_upper[axis] = cut;
  right_lower[axis] = cut;
  cut_few(points.first(left_count), left_parts, lower, left_upper, boxes);
  cut_few(points.subspan(left_count), parts - left_parts, right_lower, upper, boxes);
}

/// All points on every rank, by ascending id.
std::vector<WeightedPoint> gather_points(MPI_Comm communicator, std::span<const std::int64_t> ids, std::span<const Vec3> points,
                                         std::span<const double> weights) {
  std::vector<WeightedPoint> own, all;
  for (std::size_t i = 0; i < points.size(); ++i) own.push_back({points[i], weights[i], ids[i]});
  int size = 1;
  MPI_Comm_size(communicator, &size);
  std::vector<int> counts(static_cast<std::size_t>(size)), offsets(static_cast<std::size_t>(size), 0);
  const int own_count = static_cast<int>(own.size());
  MPI_Allgather(&own_count, 1, MPI_INT, counts.data(), 1, MPI_INT, communicator);
  std::exclusive_scan(counts.begin(), counts.end(), offsets.begin(), 0);
  all.resize(static_cast<std::size_t>(offsets.back() + counts.back()));
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(static_cast<int>(sizeof(WeightedPoint)), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Allgatherv(own.data(), own_count, type, all.data(), counts.data(), offsets.data(), type, communicator);
  MPI_Type_free(&type);
  std::sort(all.begin(), all.end(), [](const WeightedPoint& a, const WeightedPoint& b) { return a.id < b.id; });
  return all;
}

/// Zoltan cannot leave a part empty: its allocation of nothing counts as a failure, and boxes of empty parts
/// overlap others. So few points, or points that cannot be told apart, are gathered and cut on every rank alike.
CutBoxes gather_and_cut(MPI_Comm communicator, int parts, std::span<const std::int64_t> ids, std::span<const Vec3> points,
                        std::span<const double> weights) {
  std::vector<WeightedPoint> all = gather_points(communicator, ids, points, weights);
  CutBoxes boxes;
  cut_few(all, parts, {-kOuter, -kOuter, -kOuter}, {kOuter, kOuter, kOuter}, boxes);
  return boxes;
}

}  // namespace

int CutBoxes::rank_of(const Vec3& point) const {
  for (std::size_t r = 0; r < lower.size(); ++r) {
    bool inside = true;
    for (int k = 0; k < 3 && inside; ++k) {
      // an outer side holds whatever lies beyond it
      const bool above = point[k] >= lower[r][k] || lower[r][k] <= -kOuter;
      const bool below = point[k] < upper[r][k] || (upper[r][k] >= kOuter && lower[r][k] < kOuter);
      inside = above && below;
    }
    if (inside) return static_cast<int>(r);
  }
  throw InternalError(fmt::format("no rank owns the point ({:g}, {:g}, {:g})", point.x, point.y, point.z));
}

void CutBoxes::ranks_touching(const Vec3& box_lower, const Vec3& box_upper, std::vector<int>& ranks) const {
  ranks.clear();
  for (std::size_t r = 0; r < lower.size(); ++r) {
    bool touches = true;
    for (int k = 0; k < 3 && touches; ++k) {
      touches = lower[r][k] < upper[r][k] && (box_upper[k] >= lower[r][k] || lower[r][k] <= -kOuter) &&
                (box_lower[k] <= upper[r][k] || upper[r][k] >= kOuter);
    }
    if (touches) ranks.push_back(static_cast<int>(r));
  }
}

struct Partitioner::Impl {
  MPI_Comm communicator;
  int parts;
  bool gathers = false;      // see the constructor
  Zoltan_Struct* zoltan = nullptr;
  Points points;             // of the call in progress

  void set(const char* name, const std::string& value) {
    if (Zoltan_Set_Param(zoltan, name, value.c_str()) != ZOLTAN_OK) throw SystemError("Zoltan refuses {} = {}", name, value);
  }
};

Partitioner::Partitioner(MPI_Comm communicator, int parts) : impl_(std::make_unique<Impl>()) {
  SCREE_ASSERT(parts > 0, "{} parts", parts);
  impl_->communicator = communicator;
  impl_->parts = parts;
  float version = 0;
  if (Zoltan_Initialize(0, nullptr, &version) != ZOLTAN_OK) throw SystemError("Zoltan cannot be initialised");
  // With several parts on a rank, a rank whose parts stay empty makes Zoltan fail there and hang elsewhere. The
  // solver has one part a rank and the decomposer one rank; any other combination is cut on every rank alike.
  int ranks = 1;
  MPI_Comm_size(communicator, &ranks);
  impl_->gathers = ranks > 1 && parts != ranks;
  impl_->zoltan = Zoltan_Create(impl_->gathers ? MPI_COMM_SELF : communicator);
  if (impl_->zoltan == nullptr) throw SystemError("Zoltan cannot be created");
  impl_->set("DEBUG_LEVEL", "0");
  impl_->set("LB_METHOD", "RCB");
  impl_->set("NUM_GID_ENTRIES", "2");
  impl_->set("NUM_LID_ENTRIES", "1");
  impl_->set("OBJ_WEIGHT_DIM", "1");
  impl_->set("NUM_GLOBAL_PARTS", std::to_string(parts));
  impl_->set("RETURN_LISTS", "NONE");   // ownership follows from the boxes
  impl_->set("KEEP_CUTS", "1");
  impl_->set("RCB_REUSE", "1");         // these two: without them a tiny motion re-cuts in other directions
  impl_->set("RCB_LOCK_DIRECTIONS", "1");
  impl_->set("RCB_RECTILINEAR_BLOCKS", "1");  // points on a cut go to one side, so that boxes decide ownership
  Zoltan_Set_Num_Obj_Fn(impl_->zoltan, object_count, &impl_->points);
  Zoltan_Set_Obj_List_Fn(impl_->zoltan, object_list, &impl_->points);
  Zoltan_Set_Num_Geom_Fn(impl_->zoltan, dimension_count, &impl_->points);
  Zoltan_Set_Geom_Multi_Fn(impl_->zoltan, coordinates, &impl_->points);
}

Partitioner::~Partitioner() { Zoltan_Destroy(&impl_->zoltan); }

CutBoxes Partitioner::cut(std::span<const std::int64_t> ids, std::span<const Vec3> points, std::span<const double> weights) {
  SCREE_ASSERT(ids.size() == points.size() && ids.size() == weights.size(), "{} ids, {} points, {} weights", ids.size(),
               points.size(), weights.size());
  SCREE_ASSERT(points.size() < static_cast<std::size_t>(std::numeric_limits<int>::max()));
  auto total = static_cast<std::int64_t>(points.size());
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT64_T, MPI_SUM, impl_->communicator);
  if (total == 0 || impl_->parts == 1) return whole_space_first(impl_->parts);

  if (total < kFewPointsPerPart * impl_->parts) return gather_and_cut(impl_->communicator, impl_->parts, ids, points, weights);

  std::vector<std::int64_t> all_ids;
  std::vector<Vec3> all_points;
  std::vector<double> all_weights;
  impl_->points = {ids, points, weights};
  if (impl_->gathers) {
    for (const WeightedPoint& p : gather_points(impl_->communicator, ids, points, weights)) {
      all_ids.push_back(p.id);
      all_points.push_back(p.x);
      all_weights.push_back(p.weight);
    }
    impl_->points = {all_ids, all_points, all_weights};
  }
  int changed = 0, global_entries = 0, local_entries = 0, import_count = 0, export_count = 0;
  ZOLTAN_ID_PTR import_global = nullptr, import_local = nullptr, export_global = nullptr, export_local = nullptr;
  int *import_ranks = nullptr, *import_parts = nullptr, *export_ranks = nullptr, *export_parts = nullptr;
  const int status = Zoltan_LB_Partition(impl_->zoltan, &changed, &global_entries, &local_entries, &import_count, &import_global,
                                         &import_local, &import_ranks, &import_parts, &export_count, &export_global,
                                         &export_local, &export_ranks, &export_parts);
  impl_->points = {};
  int usable = status == ZOLTAN_OK || status == ZOLTAN_WARN ? 1 : 0;
  CutBoxes cuts;
  for (int part = 0; part < impl_->parts && usable == 1; ++part) {
    Vec3 lower, upper;
    int dimension = 0;
    usable = Zoltan_RCB_Box(impl_->zoltan, part, &dimension, &lower.x, &lower.y, &lower.z, &upper.x, &upper.y, &upper.z) == ZOLTAN_OK;
    for (int k = 0; k < 3; ++k) {
      lower[k] = cut_side(lower[k]);
      upper[k] = cut_side(upper[k]);
    }
    cuts.lower.push_back(lower);
    cuts.upper.push_back(upper);
  }
  if (usable == 1 && !is_tiling(cuts)) usable = 0;
  MPI_Allreduce(MPI_IN_PLACE, &usable, 1, MPI_INT, MPI_MIN, impl_->communicator);
  // so many points at one place that a part stays empty, which Zoltan does not survive
  if (usable == 0) return gather_and_cut(impl_->communicator, impl_->parts, ids, points, weights);

  std::vector<std::size_t> order(static_cast<std::size_t>(impl_->parts));
  std::iota(order.begin(), order.end(), std::size_t{0});
  order_by_cuts(cuts, order, 0, order.size());
  CutBoxes sorted;
  for (std::size_t part : order) {
    sorted.lower.push_back(cuts.lower[part]);
    sorted.upper.push_back(cuts.upper[part]);
  }
  return sorted;
}

double imbalance(std::span<const double> work_per_part) {
  const double sum = std::accumulate(work_per_part.begin(), work_per_part.end(), 0.0);
  if (!(sum > 0)) return 1;
  return *std::max_element(work_per_part.begin(), work_per_part.end()) * static_cast<double>(work_per_part.size()) / sum;
}

}  // namespace scree
