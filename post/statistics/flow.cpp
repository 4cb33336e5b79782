#include "post/statistics/flow.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <unordered_map>

#include "core/base/error.hpp"
#include "core/base/numbers.hpp"
#include "post/run/event_table.hpp"

namespace scree {

namespace {

/// An interval is to hold so many bodies on average, such that its rate is no noise; and a chart has room for so many intervals.
constexpr std::size_t kBodiesInInterval = 10, kMaxIntervals = 200, kMinIntervals = 5;

std::size_t interval_count(std::size_t bodies) { return std::clamp(bodies / kBodiesInInterval, kMinIntervals, kMaxIntervals); }

/// Name of the gate of bodies that leave the domain.
constexpr const char* kSides = "sides of the domain";

class FlowReader {
 public:
  FlowReader(const Run& run, double from, double to) : run_(run) {
    flow_.from = from;
    flow_.to = to;
    const Scene& scene = run.scene;
    for (const Inlet& inlet : scene.inlets) flow_.gates.push_back({"inlet " + inlet.name, true});
    for (const Outlet& outlet : scene.outlets) flow_.gates.push_back({"outlet " + outlet.name});
    if (scene.settings.domain.outside == Outside::remove) flow_.gates.push_back({kSides});
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const Shape& shape = scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])];
      diameter_[scene.bodies.id[i]] = scene.bodies.scale[i] * shape.equivalent_diameter();
    }
  }

  Flow read() {
    if ((flow_.gates.empty() && !run_.has_program()) || !(flow_.to > flow_.from)) return {};
    const bool lets_in = run_.lets_in(), lets_out = run_.lets_out();
    for (const char* table : {lets_in ? "/inserted.csv" : "", lets_out ? "/removed.csv" : ""}) {
      if (table[0] == 0 || std::filesystem::exists(run_.folder + table)) continue;
      Flow nothing;
      nothing.missing = run_.folder + table + ": is missing; without it there is no mass flow, and no residence times and sizes";
      return nothing;
    }
    if (lets_in) read_inserted();
    if (lets_out) read_removed();
    return std::move(flow_);
  }

 private:
  void read_inserted() {
    const EventTable table(run_.folder + "/inserted.csv", {"time", "mass", "diameter", "id"}, {"inlet"});
    for (std::size_t row = 0; row < table.rows(); ++row) {
      if (!table.is_whole(row)) continue;
      const Passage p{table.number(row, 0), table.number(row, 1), table.number(row, 2), 0};
      diameter_[static_cast<std::int64_t>(table.number(row, 3))] = p.diameter;
      const auto& inlets = run_.scene.inlets;
      if (table.text(row).empty() && run_.has_program()) {
        add(gate_of_program("inserted by the program", true), p);
        continue;
      }
      const auto at = std::find_if(inlets.begin(), inlets.end(), [&](const Inlet& i) { return i.name == table.text(row); });
      if (at == inlets.end()) table.refuse(row, fmt::format("the inlet '{}'", table.text(row)));
      add(static_cast<std::size_t>(at - inlets.begin()), p);
    }
  }

  void read_removed() {
    const EventTable table(run_.folder + "/removed.csv", {"time", "mass", "id", "residence_time"}, {"outlet"}, {"removed_by"});
    for (std::size_t row = 0; row < table.rows(); ++row) {
      if (!table.is_whole(row)) continue;
      const auto known = diameter_.find(static_cast<std::int64_t>(table.number(row, 2)));
      if (known == diameter_.end()) table.refuse(row, fmt::format("the body {:.0f}", table.number(row, 2)));
      const auto& outlets = run_.scene.outlets;
      std::size_t gate = 0;
      if (!table.text(row).empty()) {
        const auto at = std::find_if(outlets.begin(), outlets.end(), [&](const Outlet& o) { return o.name == table.text(row); });
        if (at == outlets.end()) table.refuse(row, fmt::format("the outlet '{}'", table.text(row)));
        gate = run_.scene.inlets.size() + static_cast<std::size_t>(at - outlets.begin());
      } else if (table.text(row, 1) == "program" && run_.has_program()) {
        gate = gate_of_program("removed by the program", false);
      } else {
        const auto sides = std::find_if(flow_.gates.begin(), flow_.gates.end(), [](const Gate& g) { return g.name == kSides; });
        if (sides == flow_.gates.end()) table.refuse(row, "a side of the domain at which bodies are removed");
        gate = static_cast<std::size_t>(sides - flow_.gates.begin());
      }
      add(gate, {table.number(row, 0), table.number(row, 1), known->second, table.number(row, 3)});
    }
  }

  /// Made for the first body that passes it: no scene tells whether a program inserts or removes bodies.
  std::size_t gate_of_program(const char* name, bool lets_in) {
    const auto at = std::find_if(flow_.gates.begin(), flow_.gates.end(), [&](const Gate& g) { return g.name == name; });
    if (at != flow_.gates.end()) return static_cast<std::size_t>(at - flow_.gates.begin());
    flow_.gates.push_back({name, lets_in});
    return flow_.gates.size() - 1;
  }

  void add(std::size_t gate, const Passage& p) {
    const bool is_late_enough = p.time > flow_.from || (p.time == 0 && flow_.from == 0);
    if (!is_late_enough || p.time > flow_.to) return;
    flow_.gates[gate].passed.push_back(p);
    flow_.gates[gate].mass += p.mass;
  }

  const Run& run_;
  Flow flow_;
  std::unordered_map<std::int64_t, double> diameter_;
};

/// Rates in intervals of equal length, of all gates the same: as many as the busiest gate has bodies for.
void make_rates(Flow& flow, std::size_t blocks) {
  std::size_t most = 0;
  for (const Gate& gate : flow.gates) most = std::max(most, gate.passed.size());
  const std::size_t count = interval_count(most);
  flow.width = (flow.to - flow.from) / static_cast<double>(count);
  for (std::size_t k = 1; k < count; ++k) flow.times.push_back(flow.from + static_cast<double>(k) * flow.width);
  flow.times.push_back(flow.to);
  BlockAverage average(flow.gates.size(), count, blocks);
  std::vector<std::size_t> next(flow.gates.size(), 0);
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> rates;
    for (std::size_t g = 0; g < flow.gates.size(); ++g) {
      Gate& gate = flow.gates[g];
      double mass = 0;
      for (; next[g] < gate.passed.size() && (k + 1 == count || gate.passed[next[g]].time <= flow.times[k]); ++next[g])
        mass += gate.passed[next[g]].mass;
      gate.cumulative.push_back((k > 0 ? gate.cumulative.back() : 0) + mass);
      gate.rate.push_back(mass / flow.width);
      rates.push_back(gate.rate.back());
    }
    average.add(rates);
  }
  for (std::size_t g = 0; g < flow.gates.size(); ++g) flow.gates[g].flow = average.of(g);
}

void make_residence(Gate& gate) {
  if (gate.lets_in || !(gate.mass > 0)) return;
  double first = 0, second = 0;
  for (const Passage& p : gate.passed) first += p.mass * p.residence;
  const double mean = first / gate.mass;
  for (const Passage& p : gate.passed) second += p.mass * (p.residence - mean) * (p.residence - mean);
  gate.deviation = std::sqrt(second / gate.mass);
  const auto [shortest, longest] = std::minmax_element(gate.passed.begin(), gate.passed.end(),
                                                       [](const Passage& a, const Passage& b) { return a.residence < b.residence; });
  gate.residence = {mean, kNaN, shortest->residence, longest->residence, gate.passed.size()};
  const ShareCurve curve = share_curve(gate, &Passage::residence);
  const auto half = std::find_if(curve.share.begin(), curve.share.end(), [](double share) { return share >= 0.5; });
  gate.median = curve.value[static_cast<std::size_t>(half - curve.share.begin())];
}

}  // namespace

Flow read_flow(const Run& run, double from, double to, std::size_t blocks) {
  Flow flow = FlowReader(run, from, to).read();
  if (flow.empty()) return flow;
  make_rates(flow, blocks);
  for (Gate& gate : flow.gates) make_residence(gate);
  return flow;
}

ShareCurve share_curve(const Gate& gate, double Passage::*number) {
  std::vector<std::size_t> order(gate.passed.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return gate.passed[a].*number < gate.passed[b].*number; });
  ShareCurve curve;
  double below = 0;
  for (std::size_t n = 0; n < order.size(); ++n) {
    const Passage& p = gate.passed[order[n]];
    below += p.mass;
    const bool is_last = n + 1 == order.size();
    if (!is_last && gate.passed[order[n + 1]].*number == p.*number) continue;
    curve.value.push_back(p.*number);
    curve.share.push_back(is_last ? 1 : below / gate.mass);
  }
  return curve;
}

Density residence_density(const Gate& gate) {
  Density density;
  double longest = 0;
  for (const Passage& p : gate.passed) longest = std::max(longest, p.residence);
  if (gate.lets_in || !(longest > 0)) return density;
  const std::size_t count = interval_count(gate.passed.size());
  const double width = density.width = longest / static_cast<double>(count);
  density.value.assign(count, 0.0);
  for (const Passage& p : gate.passed)
    density.value[std::min(count - 1, static_cast<std::size_t>(p.residence / width))] += p.mass / (gate.mass * width);
  double share = 0;
  for (std::size_t k = 0; k < count; ++k) {
    density.end.push_back(static_cast<double>(k + 1) * width);
    density.share.push_back(share += density.value[k] * width);
  }
  return density;
}

nlohmann::json json_of(const Flow& flow) {
  const auto number = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); };
  nlohmann::json gates = nlohmann::json::object();
  for (const Gate& gate : flow.gates) {
    nlohmann::json& entry = gates[gate.name];
    entry = {{"bodies", gate.passed.size()},
             {"mass", gate.mass},
             {"mass_flow", {{"mean", number(gate.flow.mean)}, {"ci95", number(gate.flow.ci95)}, {"unit", "kg/s"}}}};
    if (gate.residence.count > 0) {
      entry["residence_time"] = {
          {"mean", gate.residence.mean}, {"standard_deviation", gate.deviation}, {"median", gate.median}, {"unit", "s"}};
    }
  }
  return {{"from", flow.from}, {"to", flow.to}, {"gates", gates}};
}

}  // namespace scree
