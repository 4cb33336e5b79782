#include "post/run/impacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"

namespace scree {

namespace {

/// Sums at a frame by pair of materials, and by the lower end of the bin.
struct SumsAt {
  struct Losses {
    double damping = 0, friction = 0, rolling = 0;
  };
  std::map<std::pair<int, int>, Losses> losses;
  std::map<std::pair<int, int>, std::map<double, ImpactBinRow>> bins;
};

SumsAt sums_at(const Frame& frame) {
  SumsAt sums;
  const FrameLosses& l = frame.losses;
  for (std::size_t i = 0; i < l.size(); ++i) sums.losses[{l.material_a[i], l.material_b[i]}] = {l.damping[i], l.friction[i], l.rolling[i]};
  const FrameImpacts& m = frame.impacts;
  for (std::size_t i = 0; i < m.size(); ++i) {
    sums.bins[{m.material_a[i], m.material_b[i]}][m.energy_from[i]] = {m.energy_from[i], m.energy_to[i],     m.normal_count[i],
                                                                       m.shear_count[i], m.normal_energy[i], m.shear_energy[i]};
  }
  return sums;
}

const std::string& material_name(const Scene& scene, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= scene.materials.size())
    throw InputError("impacts of a frame are of material {}, but the scene has {}; the frame is damaged or of another scene", index,
                     scene.materials.size());
  return scene.materials[static_cast<std::size_t>(index)].name;
}

}  // namespace

bool has_impacts(const Scene& scene) { return scene.settings.output_impacts; }

std::vector<MaterialPairImpacts> impacts_between(const Scene& scene, const Frame& from, const Frame& to) {
  if (has_impacts(scene) && to.losses.size() == 0)
    throw InputError("a frame at {} s holds no impacts, but the scene asks for them; the frame is damaged or of another scene", to.time);
  SumsAt before = sums_at(from), now = sums_at(to);
  std::vector<MaterialPairImpacts> pairs;
  for (const auto& [key, last] : now.losses) {
    const SumsAt::Losses first = before.losses[key];
    MaterialPairImpacts pair{material_name(scene, key.first),
                             material_name(scene, key.second),
                             {},
                             last.damping - first.damping,
                             last.friction - first.friction,
                             last.rolling - first.rolling,
                             0,
                             0,
                             0};
    for (const auto& [end, bin] : now.bins[key]) {
      const auto known = before.bins[key].find(end);
      const ImpactBinRow old = known == before.bins[key].end() ? ImpactBinRow{} : known->second;
      const ImpactBinRow row{bin.from,
                             bin.to,
                             bin.normal_count - old.normal_count,
                             bin.shear_count - old.shear_count,
                             bin.normal_energy - old.normal_energy,
                             bin.shear_energy - old.shear_energy};
      pair.normal_count += row.normal_count;
      pair.normal_energy += row.normal_energy;
      pair.shear_energy += row.shear_energy;
      if (row.normal_count > 0 || row.shear_count > 0) pair.bins.push_back(row);
    }
    if (!pair.bins.empty() || pair.lost() != 0) pairs.push_back(std::move(pair));
  }
  return pairs;
}

std::vector<LoadTable> impact_tables(const Run& run, const std::vector<std::size_t>& frames) {
  if (!has_impacts(run.scene) || frames.empty()) return {};
  LoadTable spectrum{"impacts.csv",
                     "material_a,material_b,energy_from,energy_to,normal_count,normal_energy,normal_rate,shear_count,shear_energy,"
                     "shear_rate\n# units: -,-,J,J,-,J,1/s,-,J,1/s\n"};
  LoadTable losses{"losses.csv",
                   "time,material_a,material_b,damping,friction,rolling,damping_power,friction_power,rolling_power\n"
                   "# units: s,-,-,J,J,J,W,W,W\n"};
  // since the start of the run where there is one frame alone
  const Frame first = frames.size() > 1 ? load_frame(run, frames.front()) : Frame{};
  Frame before = first;
  for (std::size_t k = frames.size() > 1 ? 1 : 0; k < frames.size(); ++k) {
    Frame now = load_frame(run, frames[k]);
    const double per = now.time > before.time ? 1 / (now.time - before.time) : 0;
    const std::vector<MaterialPairImpacts> so_far = impacts_between(run.scene, Frame{}, now);
    std::map<std::pair<std::string, std::string>, MaterialPairImpacts> since;
    for (const MaterialPairImpacts& pair : impacts_between(run.scene, before, now)) since[{pair.material_a, pair.material_b}] = pair;
    for (const MaterialPairImpacts& pair : so_far) {
      const MaterialPairImpacts& lately = since[{pair.material_a, pair.material_b}];
      losses.text += fmt::format("{:.9g},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", now.time, csv_cell(pair.material_a),
                                 csv_cell(pair.material_b), pair.damping, pair.friction, pair.rolling, per * lately.damping,
                                 per * lately.friction, per * lately.rolling);
    }
    before = std::move(now);
  }
  const double time = before.time - first.time, per = time > 0 ? 1 / time : 0;
  for (const MaterialPairImpacts& pair : impacts_between(run.scene, first, before)) {
    for (const ImpactBinRow& bin : pair.bins) {
      spectrum.text +=
          fmt::format("{},{},{:.9g},{:.9g},{},{:.9g},{:.9g},{},{:.9g},{:.9g}\n", csv_cell(pair.material_a), csv_cell(pair.material_b),
                      bin.from, bin.to, bin.normal_count, bin.normal_energy, per * static_cast<double>(bin.normal_count), bin.shear_count,
                      bin.shear_energy, per * static_cast<double>(bin.shear_count));
    }
  }
  return {std::move(spectrum), std::move(losses)};
}

LineChart impact_chart(const std::vector<MaterialPairImpacts>& pairs, double time) {
  LineChart chart{"Impacts by energy", "energy of the impact", "J", "impacts per second and power of two", "", true, false, {}, {}, true};
  // contacts that tremble at rest begin again and again: their energies would take up most of the axis
  constexpr double kDrawn = 1e-9;  // of the largest
  double largest = 0;
  for (const MaterialPairImpacts& pair : pairs) {
    if (!pair.bins.empty()) largest = std::max(largest, pair.bins.back().to);
  }
  for (const MaterialPairImpacts& pair : pairs) {
    for (const bool normal : {true, false}) {
      ChartLine line;
      line.name = fmt::format("{} - {}, {}", pair.material_a, pair.material_b, normal ? "normal" : "shear");
      for (const ImpactBinRow& bin : pair.bins) {
        const std::int64_t count = normal ? bin.normal_count : bin.shear_count;
        if (count == 0 || !(time > 0) || bin.to < kDrawn * largest) continue;
        line.x.push_back(std::sqrt(bin.from * bin.to));
        line.y.push_back(static_cast<double>(count) / time / std::log2(bin.to / bin.from));
      }
      if (!line.x.empty()) chart.lines.push_back(std::move(line));
    }
  }
  return chart;
}

}  // namespace scree
