#include "tests/benchmarks/distance/study.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>

#include "core/base/error.hpp"
#include "tests/benchmarks/distance/methods/indexed_distance.hpp"
#include "tests/benchmarks/distance/published_methods.hpp"
#include "tests/distance/exact_oracle.hpp"

namespace scree {
namespace {

constexpr const char* kIndexed = "brute-force-indexed";

/// All triangles A as one shape, all B as another that lies turned and shifted in its own frame; pairs by index, the
/// triangles in a random order.
std::function<void(const AnswerBatch<float>&)> indexed_runner(const std::vector<Pair18>& pairs) {
  Random random(5);
  Placement placement;
  const Quat turn = random.rotation();
  placement.rotation = matrix_of(turn);
  placement.translation = {0.5, -0.25, 0.125};
  std::vector<std::size_t> order(pairs.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
  TriangleMesh meshes[2];
  std::vector<TrianglePair> indices(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto t = static_cast<std::int32_t>(i);
    for (int k = 0; k < 3; ++k) {
      meshes[0].vertices.push_back(corner(pairs[order[i]], k));
      meshes[1].vertices.push_back(rotate_inverse(turn, corner(pairs[order[i]], 3 + k) - placement.translation));
    }
    for (TriangleMesh& mesh : meshes) mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    indices[order[i]] = {t, t};
  }
  const auto a = std::make_shared<TriangleRows>(meshes[0]), b = std::make_shared<TriangleRows>(meshes[1]);
  return [=](const AnswerBatch<float>& out) { triangle_distances(*a, *b, placement, indices, out); };
}

template <class Real>
std::function<void(const PairBatch<Real>&, const AnswerBatch<Real>&)> runner_of(const std::string& method,
                                                                                const std::vector<Pair18>& pairs) {
  using In = PairBatch<Real>;
  using Out = AnswerBatch<Real>;
  const auto published = [](PublishedMethod m) { return [m](const In& in, const Out& out) { published_distances(m, in, out); }; };
  if (method == "pen4") return published(PublishedMethod::pen4);
  if (method == "pen7") return published(PublishedMethod::pen7);
  if (method == "pen4-hybrid") return published(PublishedMethod::pen4_hybrid);
  if (method == "pen7-hybrid") return published(PublishedMethod::pen7_hybrid);
  if (method == kIndexed) {
    if constexpr (sizeof(Real) == 4) return [run = indexed_runner(pairs)](const In&, const Out& out) { run(out); };
    throw UsageError("--method {}: in single precision only; add --precision single", method);
  }
  if (method == "brute-force-distance") return [](const In& in, const Out& out) { triangle_distances(in, out.distance); };
  const DistanceMethod own = distance_method_of(method);
  return [own](const In& in, const Out& out) { triangle_distances(own, in, out); };
}

/// An array that begins on a cache line: vectors that straddle two take longer to load.
template <class Real>
class LineAligned {
 public:
  explicit LineAligned(std::size_t size) : values_(size + 64 / sizeof(Real)) {
    const auto address = reinterpret_cast<std::uintptr_t>(values_.data());
    begin_ = values_.data() + (64 - address % 64) % 64 / sizeof(Real);
  }
  Real* data() { return begin_; }
  Real& operator[](std::size_t i) { return begin_[i]; }

 private:
  std::vector<Real> values_;
  Real* begin_;
};

template <class Real>
StudyRow run_typed(const StudyCase& study, const std::string& method, double seconds, std::vector<AnswerRecord>* answers) {
  const std::size_t count = study.pairs.size();
  std::int64_t stride = 0;
  const std::vector<double> values = structure_of_arrays(study.pairs, stride);
  LineAligned<Real> input(values.size());
  // past the count: the last pair again, so that no made-up number sends a lane into a rare branch
  for (std::size_t c = 0; c < 18; ++c)
    for (std::size_t i = 0; i < static_cast<std::size_t>(stride); ++i)
      input[c * static_cast<std::size_t>(stride) + i] =
          static_cast<Real>(values[c * static_cast<std::size_t>(stride) + std::min(i, count - 1)]);
  const auto padded = static_cast<std::size_t>(stride);
  LineAligned<Real> distance(padded), points(6 * padded), code(padded);
  const PairBatch<Real> in{input.data(), stride, static_cast<std::int64_t>(count)};
  const AnswerBatch<Real> out{distance.data(), points.data(), code.data(), stride};
  const auto run = runner_of<Real>(method, study.pairs);

  StudyRow row;
  run(in, out);
  double best = 1e30, spent = 0;
  while (spent < seconds) {
    const auto start = std::chrono::steady_clock::now();
    run(in, out);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    best = std::min(best, time.count());
    spent += time.count();
  }
  row.nanoseconds = 1e9 * best / static_cast<double>(count);

  std::vector<double> errors;
  std::size_t wrong = 0, uncertified = 0, fallbacks = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto d = static_cast<double>(distance[i]);
    const auto c = static_cast<double>(code[i]);
    if (std::isnan(d)) ++row.not_a_number;
    uncertified += is_uncertified(c) ? 1 : 0;
    fallbacks += fell_back(c) ? 1 : 0;
    if (i >= study.truth.size()) continue;
    const double truth = study.truth[i], size = std::max(longest_edge(study.pairs[i]), truth);
    errors.push_back(std::isnan(d) ? 1e300 : (size > 0 ? std::abs(d - truth) / size : d));
    wrong += (d == 0) != (truth == 0) ? 1 : 0;
  }
  if (!errors.empty()) {
    std::sort(errors.begin(), errors.end());
    row.error_median = errors[errors.size() / 2];
    row.error_p99 = errors[errors.size() * 99 / 100];
    row.error_max = errors.back();
    row.wrong_flags = static_cast<double>(wrong) / static_cast<double>(errors.size());
  }
  row.uncertified = static_cast<double>(uncertified) / static_cast<double>(count);
  row.fell_back = static_cast<double>(fallbacks) / static_cast<double>(count);
  if (answers == nullptr) return row;
  answers->clear();
  for (std::size_t i = 0; i < count; ++i) {
    AnswerRecord record{};
    const auto c = static_cast<double>(code[i]);
    record.distance = static_cast<double>(distance[i]);
    for (int k = 0; k < 3; ++k) {
      record.point_a[k] = static_cast<double>(points[static_cast<std::size_t>(k) * padded + i]) + study.origins[i][k];
      record.point_b[k] = static_cast<double>(points[static_cast<std::size_t>(3 + k) * padded + i]) + study.origins[i][k];
    }
    const auto [a, b] = features_of(c);
    record.feature = static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b) << 4;
    record.flags = (record.distance == 0 ? 1u : 0u) | (is_uncertified(c) ? 2u : 0u) | (fell_back(c) ? 4u : 0u);
    answers->push_back(record);
  }
  return row;
}

}  // namespace

const std::vector<std::string>& study_methods() {
  static const std::vector<std::string> names = {"brute-force", "brute-force-distance", "penalty",     "hybrid", "pen4",
                                                 "pen7",        "pen4-hybrid",          "pen7-hybrid", kIndexed};
  return names;
}
bool has_precision(const std::string& method, bool single) { return single || method != kIndexed; }

double operations_of(const std::string& method, bool single) {
  if (method != "brute-force") return 0;
  return single ? 130 + 153 + 2 * 302 + 17 + 2 : 109 + 143 + 2 * 271 + 17 + 1;  // add, multiply, multiply-add, divide, root
}

StudyCase make_study_case(const std::string& name, const std::vector<Pair18>& pairs, bool single, std::size_t checked) {
  StudyCase study{name, single, pairs, {}, {}};
  for (Pair18& p : study.pairs) {
    Vec3 origin;
    if (single) {
      // single precision works in the frame of a body, never in the world's
      origin = corner(p, 0);
      for (std::size_t i = 0; i < 18; ++i) {
        const volatile float rounded = static_cast<float>(p[i] - origin[static_cast<int>(i % 3)]);
        p[i] = rounded;
      }
    }
    study.origins.push_back(origin);
  }
  for (std::size_t i = 0; i < std::min(checked, pairs.size()); ++i)
    study.truth.push_back(static_cast<double>(oracle::distance(study.pairs[i].data())));
  return study;
}

StudyRow run_study(const StudyCase& study, const std::string& method, double seconds, std::vector<AnswerRecord>* answers) {
  if (answers != nullptr && method == "brute-force-distance")
    throw UsageError("--answers: brute-force-distance has no points; use brute-force");
  return study.single ? run_typed<float>(study, method, seconds, answers) : run_typed<double>(study, method, seconds, answers);
}

}  // namespace scree
