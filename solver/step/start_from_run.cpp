#include "solver/step/start_from_run.hpp"

#include <algorithm>
#include <tuple>
#include <type_traits>
#include <unordered_set>

#include "core/base/error.hpp"

namespace scree {

namespace {

/// a + b as the nearest double and what it lacks (D. Knuth, The Art of Computer Programming 2, 4.2.2).
void add_exactly(double& a, double& b) {
  const double sum = a + b, part = sum - a;
  b = (a - (sum - part)) + (b - part);
  a = sum;
}

/// The rows of a table as rows of that kind, by pair.
template <class Row>
std::vector<KeyedRow<Row>> rows_of(const PairTable& table) {
  std::vector<KeyedRow<Row>> rows(table.size());
  for (std::size_t n = 0; n < rows.size(); ++n) rows[n].key = {table.a[n], table.b[n], static_cast<std::int32_t>(table.zone[n])};
  PairKind<Row>::visit([&](const char* name, const char*, auto field) {
    using Value = std::decay_t<decltype(Row{}.*field)>;
    const auto column = std::find_if(table.columns.begin(), table.columns.end(), [&](const PairColumn& c) { return c.name == name; });
    if (column == table.columns.end() && is_later_column<PairKind<Row>>(name)) return;  // of an older checkpoint
    const auto* values = column == table.columns.end() ? nullptr : std::get_if<std::vector<Value>>(&column->values);
    if (values == nullptr) throw InputError("the scene's start/pairs/{} has no column {} of the right kind", table.kind, name);
    for (std::size_t n = 0; n < rows.size(); ++n) rows[n].row.*field = (*values)[n];
  });
  return rows;
}

void check_keys(const SolverScene& scene, const StartState& start, const PairTable& table) {
  const Scene& source = scene.source();
  const std::unordered_set<std::int64_t> ids(source.bodies.id.begin(), source.bodies.id.begin() + start.bodies);
  const auto zones = static_cast<std::int64_t>(scene.zones().size());
  for (std::size_t n = 0; n < table.size(); ++n) {
    const std::int64_t zone = table.zone[n];
    const bool partner_known =
        zone < 0
            ? ids.contains(table.b[n])
            : zone < zones && table.b[n] == source.walls[static_cast<std::size_t>(scene.zones()[static_cast<std::size_t>(zone)].wall)].id;
    if (partner_known && zone >= -1 && ids.contains(table.a[n])) continue;
    throw InputError("the scene's start/pairs/{} names the pair {}, {} (zone {}), which the scene does not have", table.kind, table.a[n],
                     table.b[n], zone);
  }
}

}  // namespace

ParticleRecord starting_record(const SolverScene& scene, const StartState& start, std::size_t body) {
  ParticleRecord r = initial_record(scene, body);
  if (body >= start.q_principal.size()) return r;
  r.x_remainder = start.x_remainder[body];
  // a scene that is computed about another origin has other last digits
  for (int k = 0; k < 3; ++k) add_exactly(r.x[k], r.x_remainder[k]);
  r.q = start.q_principal[body];
  r.q_remainder = start.q_remainder[body];
  return r;
}

std::vector<WaitingState> starting_pairs(const SolverScene& scene, const StartState& start, const std::vector<ParticleRecord>& mine) {
  std::vector<WaitingState> states;
  std::vector<KeyedRow<FrictionSpring>> springs;
  std::unordered_set<std::int64_t> own;
  for (const ParticleRecord& r : mine) own.insert(r.id);
  for (const PairTable& table : start.pairs) {
    check_keys(scene, start, table);
    bool known = false;
    for_each_table([&]<class Row>() {
      if (table.kind != PairKind<Row>::kGroup) return;
      known = true;
      if constexpr (!std::is_same_v<Row, KeptForce>) {  // a run begins with all bodies awake
        for (const KeyedRow<FrictionSpring>& r : as_in_state(rows_of<Row>(table))) {
          if (own.contains(r.key.a) || (r.key.zone < 0 && own.contains(r.key.b))) springs.push_back(r);
        }
      }
    });
    if (!known) throw InputError("the scene's start/pairs/{}: this version of the solver knows no such state of pairs", table.kind);
  }
  std::sort(springs.begin(), springs.end(),
            [](const auto& l, const auto& r) { return std::tie(l.key, l.row.key) < std::tie(r.key, r.row.key); });
  add_rows(springs, states);
  merge(states);
  return states;
}

void count_starting_springs(RunState& s) {
  // both owners of a pair have its result; its pairs come in the same order to a body on any rank
  ParticleSet& p = s.particles;
  for (std::size_t k = 0; k < s.pairs.pairs().size(); ++k) {
    const BodyPair& pair = s.pairs.pairs()[k];
    const PairResult& result = s.pairs.results()[k];
    if (!result.active) continue;
    const double share = pair.b < 0 ? result.tangential_elastic : 0.5 * result.tangential_elastic;
    for (const std::int32_t body : {pair.a, pair.b}) {
      if (body >= 0 && static_cast<std::size_t>(body) < p.owned) p.dissipated[static_cast<std::size_t>(body)] += share;
    }
  }
}

}  // namespace scree
