#include "post/statistics/fragments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "post/run/bonds_in_frame.hpp"
#include "post/run/output_file.hpp"

namespace scree {

namespace {

constexpr double kFine = 0.1;  // of the diameter of the parent: the 10 of t10

}  // namespace

std::vector<Fragment> fragments_of(const Scene& scene, const FrameBodies& bodies, const std::vector<std::int64_t>& holding) {
  const std::vector<std::int64_t> now = fragment_ids(scene, bodies, holding), parent = fragment_ids(scene, bodies, all_bonds(scene));
  std::map<std::int64_t, Fragment> by_id;
  std::map<std::int64_t, double> volume;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (now[i] < 0) continue;
    const std::int64_t id = now[i];
    Fragment& f = by_id[id];
    f.id = id;
    f.parent = parent[i];
    ++f.pieces;
    const double s = bodies.scale[i];
    f.mass += scene.mass(bodies.shape[i], bodies.material[i], s);
    volume[id] += s * s * s * scene.shapes[static_cast<std::size_t>(bodies.shape[i])].mass.volume;
  }
  std::vector<Fragment> all;
  for (auto& [id, f] : by_id) {
    f.diameter = std::cbrt(6 * volume[id] / std::numbers::pi);
    all.push_back(f);
  }
  std::sort(all.begin(), all.end(),
            [](const Fragment& l, const Fragment& r) { return std::tuple(l.parent, -l.mass, l.id) < std::tuple(r.parent, -r.mass, r.id); });
  return all;
}

FragmentNumbers numbers_of(const std::vector<Fragment>& fragments, const std::vector<Fragment>& at_start) {
  std::map<std::int64_t, Fragment> parents;
  double total = 0;
  for (const Fragment& p : at_start) {
    parents[p.parent] = p;
    total += p.mass;
  }
  FragmentNumbers numbers;
  numbers.fragments = fragments.size();
  std::map<std::int64_t, double> largest;
  double fine = 0, large = 0, there = 0;
  for (const Fragment& f : fragments) {
    there += f.mass;
    double& most = largest[f.parent];
    most = std::max(most, f.mass);
    const auto parent = parents.find(f.parent);
    if (parent == parents.end())
      throw InputError("pieces of body {} are in a frame, but not in the first one; frames are missing or out of order", f.parent);
    if (f.diameter < kFine * parent->second.diameter) fine += f.mass;
  }
  for (const auto& [parent, mass] : largest) large += mass;
  if (total > 0) {
    numbers.largest_share = large / total;
    numbers.t10 = fine / total;
    numbers.present = there / total;
  }
  return numbers;
}

std::string write_fragments(const Run& run, const std::string& path, const std::string& sizes) {
  if (run.scene.bonds.empty()) throw InputError("{}: the scene has no bonds, and nothing that could come apart", run.folder);
  OutputFile file(path);
  file.add("time,bonds,fragments,largest_share,t10,present\n");
  std::vector<Fragment> at_start, last;
  FragmentNumbers numbers;
  LongWork work("fragments", static_cast<double>(run.frames.size()));
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    work.advance();
    const Frame frame = load_frame(run, f);
    if (f == 0) at_start = fragments_of(run.scene, frame.bodies, all_bonds(run.scene));
    last = fragments_of(run.scene, frame.bodies, frame.bonds.bond);
    numbers = numbers_of(last, at_start);
    file.add(fmt::format("{},{},{},{},{},{}\n", frame.time, frame.bonds.size(), numbers.fragments, numbers.largest_share, numbers.t10,
                         numbers.present));
  }
  file.commit();
  if (!sizes.empty()) {
    OutputFile table(sizes);
    table.add("id,parent,pieces,mass,diameter\n");
    for (const Fragment& f : last) table.add(fmt::format("{},{},{},{},{}\n", f.id, f.parent, f.pieces, f.mass, f.diameter));
    table.commit();
  }
  constexpr double kAll = 1 - 1e-9;
  return fmt::format(
      "{} fragments of {} bodies in the last frame; the largest of each has {:.3g} of its mass; t10 {:.3g}{}\n", numbers.fragments,
      at_start.size(), numbers.largest_share, numbers.t10,
      numbers.present < kAll ? fmt::format("; {:.3g} of the mass has left, and counts as neither", 1 - numbers.present) : "");
}

}  // namespace scree
