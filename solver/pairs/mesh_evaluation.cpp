#include "solver/pairs/mesh_evaluation.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "solver/contact/overlap_limit.hpp"
#include "solver/contact/pair_friction.hpp"
#include "solver/neighbours/lane_rows.hpp"

namespace scree {

namespace {

constexpr std::size_t kGradient = offsetof(ContactFeature, weight_gradient) / sizeof(double),
                      kKey = offsetof(ContactFeature, key) / sizeof(double);
static_assert(offsetof(ContactFeature, faded) == MeshFeature::kRow * sizeof(double) &&
              offsetof(ContactFeature, overlap) == 3 * sizeof(double) && offsetof(ContactFeature, n) == 4 * sizeof(double) &&
              offsetof(ContactFeature, weight) == 7 * sizeof(double) && kGradient == 8 && std::is_trivially_copyable_v<ContactFeature>);

/// One feature and its spring.
void set(const ContactFeature& f, const FrictionSpring* spring, std::size_t n, MeshFeature& to) {
  std::array<double, MeshFeature::kRow>& row = to.row[n];
  std::memcpy(row.data(), &f, sizeof(row));
  // a gradient that is not used may have zeros of either sign
  if (!f.faded) std::fill_n(&row[kGradient], sizeof(Feature6) / sizeof(double), 0.0);
  to.kept[n] = spring != nullptr ? 1 : 0;
  if (spring != nullptr) {
    store(*spring, &to.spring[4 * n]);
    store(spring->normal, &to.normal[4 * n]);
  } else {
    std::fill_n(&to.spring[4 * n], 4, 0.0);
    std::fill_n(&to.normal[4 * n], 4, 0.0);
  }
}
std::int64_t key_of(const MeshFeature& f, std::size_t n) {
  std::int64_t key = 0;
  std::memcpy(&key, &f.row[n][kKey], sizeof(key));
  return key;
}

/// Lanes have no rolling resistance of meshes, and take no time of a pair.
bool suits_lanes(const PairPass& pass) {
  return pass.asks_for_forces_alone() && pass.scratch.pair_seconds.empty() && !pass.scene.law_choice().rolling;
}

}  // namespace

MeshPass::MeshPass(PairPass& pass)
    : pass_(pass),
      has_lanes_(suits_lanes(pass) && pass.scene.lane_laws().kind != LaneLawKind::none),
      scene_{pass.p, pass.p.cell.periodicity(), pass.scene.lane_laws()} {}

MeshEvaluation::Batches& MeshEvaluation::batches_of_thread() {
  thread_local Batches batches;
  return batches;
}

MeshEvaluation::MeshEvaluation(const MeshPass& meshes) : meshes_(meshes), pass_(meshes.pass()), batches_(batches_of_thread()) {
  for (MeshPairs& batch : batches_) batch.count = 0;  // a pass that failed may have left some
}

void MeshEvaluation::add(std::int32_t k, std::size_t law, const BodyPair& pair, const PairView& view, const PairFeatures& features) {
  const std::size_t count = features.list.size();
  MeshPairs& batch = batches_[count - 1];
  if (batch.features.empty()) batch.features.resize(count);
  const std::size_t n = batch.count++;
  batch.index[n] = k;
  batch.a[n] = pair.a;
  batch.b[n] = pair.b;
  batch.law[n] = static_cast<std::int64_t>(law);
  batch.max_overlap[n] = view.max_overlap;
  batch.cluster_share[n] = features.cluster_share;
  const std::vector<FrictionSpring>& springs = pair.state.springs;
  const bool turned = !springs.empty() && springs.back().key == Turn::kKey;
  batch.turned[n] = turned ? 1 : 0;
  if (turned) store(springs.back(), &batch.turn[4 * n]);
  auto old = springs.begin();
  const std::vector<HandedOver>* handed_over = nullptr;
  for (std::size_t j = 0; j < count; ++j) {
    const ContactFeature& f = features.list[j];
    while (old != springs.end() && old->key < f.key) ++old;
    const FrictionSpring* spring = old != springs.end() && old->key == f.key ? &*old : nullptr;
    if (spring == nullptr && !springs.empty() && features.hands_over && is_handed_over(f.key)) {
      if (handed_over == nullptr)
        handed_over = &find_handed_over(features.list, nullptr, springs, MeanTurn(springs, view.pose.turn, pass_.friction_dt));
      for (const HandedOver& h : *handed_over)
        if (h.feature == f.key) spring = h.spring;
    }
    set(f, spring, n, batch.features[j]);
  }
  if (batch.count == kMeshPairs) evaluate(batch);
}

/// The forces of a batch, handed out to its pairs.
void MeshEvaluation::evaluate(MeshPairs& batch) {
  find_mesh_forces(meshes_.scene(), pass_.dt, batch, forces_);
  const bool friction = meshes_.scene().laws.friction;
  const std::size_t count = batch.features.size();
  for (std::size_t n = 0; n < batch.count; ++n) {
    const auto k = static_cast<std::size_t>(batch.index[n]);
    PairResult& result = pass_.list.stored_results()[k];
    load(forces_.fours, n, result);
    if (forces_.left[n] != 0 || (pass_.continues && !(result.overlap_ratio < kLookFrom))) {
      left_.push_back(batch.index[n]);
      continue;
    }
    result.active = true;
    result.contact_count = static_cast<std::int32_t>(count);
    largest_overlap_ = std::max(largest_overlap_, result.overlap_ratio);
    if (!(result.overlap_ratio < pass_.stop_ratio)) too_deep_ = true;  // or not a number
    std::vector<FrictionSpring>& springs = pass_.list.stored_pairs()[k].state.springs;
    if (!friction) {
      springs.clear();
      continue;
    }
    springs.resize(count + 1);
    for (std::size_t j = 0; j < count; ++j) {
      springs[j].key = key_of(batch.features[j], n);
      load(&batch.features[j].spring[4 * n], springs[j]);
      load(&batch.features[j].normal[4 * n], springs[j].normal);
    }
    springs[count].key = Turn::kKey;
    springs[count].normal = {};
    load(&batch.turn[4 * n], springs[count]);
  }
  batch.count = 0;
}

void MeshEvaluation::finish() {
  for (MeshPairs& batch : batches_) {
    if (batch.count > 0) evaluate(batch);
  }
}

}  // namespace scree
