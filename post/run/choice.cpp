#include "post/run/choice.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include "core/base/error.hpp"

namespace scree {

namespace {

std::int64_t integer_in(const std::string& text, const std::string& where) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) throw UsageError("{}: '{}' is not a whole number", where, text);
  return value;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words;
  std::size_t begin = 0;
  for (std::size_t end = text.find(separator); end != std::string::npos; end = text.find(separator, begin)) {
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  words.push_back(text.substr(begin));
  return words;
}

std::vector<bool> named(const std::vector<std::string>& wanted, const std::vector<std::string>& names, const char* what) {
  std::vector<bool> chosen(names.size(), wanted.empty());
  for (const std::string& name : wanted) {
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end()) {
      std::string known;
      for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
      throw UsageError("--{} {}: the scene has no such {}; it has: {}", what, name, what, known);
    }
    chosen[static_cast<std::size_t>(it - names.begin())] = true;
  }
  return chosen;
}

}  // namespace

std::vector<std::size_t> choose_frames(const Run& run, const std::string& text) {
  std::vector<std::size_t> chosen;
  const std::string where = "--frames " + text;
  if (text.empty() || text == "all") {
    for (std::size_t i = 0; i < run.frames.size(); ++i) chosen.push_back(i);
    return chosen;
  }
  if (text == "last") return {run.frames.size() - 1};
  for (const std::string& part : split(text, ',')) {
    const std::vector<std::string> ends = split(part, ':');
    if (ends.size() == 1) {
      chosen.push_back(find_frame(run, integer_in(part, where), "--frames"));
      continue;
    }
    if (ends.size() > 3) throw UsageError("{}: '{}' is no range; expected first:last or first:last:step", where, part);
    const std::size_t first = ends[0].empty() ? 0 : find_frame(run, integer_in(ends[0], where), "--frames");
    const std::size_t last = ends[1].empty() ? run.frames.size() - 1 : find_frame(run, integer_in(ends[1], where), "--frames");
    const std::int64_t step = ends.size() == 3 && !ends[2].empty() ? integer_in(ends[2], where) : 1;
    if (step < 1) throw UsageError("{}: the step is {}; it must be 1 or more", where, step);
    for (std::size_t i = first; i <= last; i += static_cast<std::size_t>(step)) chosen.push_back(i);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  if (chosen.empty()) throw UsageError("{}: names no frame; first:last goes upwards", where);
  return chosen;
}

ChosenBodies::ChosenBodies(const BodyChoice& choice, const Scene& scene) : regions_(choice.regions) {
  std::vector<std::string> materials, shapes;
  for (const Material& m : scene.materials) materials.push_back(m.name);
  for (const Shape& s : scene.shapes) shapes.push_back(s.name);
  material_ = named(choice.materials, materials, "material");
  shape_ = named(choice.shapes, shapes, "shape");
  for (const std::string& list : choice.ids) {
    for (const std::string& part : split(list, ',')) {
      const std::size_t dash = part.find('-', 1);
      const std::int64_t first = integer_in(part.substr(0, dash), "--ids");
      ids_.emplace_back(first, dash == std::string::npos ? first : integer_in(part.substr(dash + 1), "--ids"));
    }
  }
  all_ = choice.ids.empty() && choice.materials.empty() && choice.shapes.empty() && choice.regions.empty();
}

bool ChosenBodies::holds(const FrameBodies& bodies, std::size_t index) const {
  if (all_) return true;
  if (!material_[static_cast<std::size_t>(bodies.material[index])] || !shape_[static_cast<std::size_t>(bodies.shape[index])]) return false;
  const std::int64_t id = bodies.id[index];
  if (!ids_.empty() && std::none_of(ids_.begin(), ids_.end(), [id](const auto& r) { return id >= r.first && id <= r.second; }))
    return false;
  const Vec3& x = bodies.position[index];
  return regions_.empty() || std::any_of(regions_.begin(), regions_.end(), [&x](const Region& r) { return r.contains(x); });
}

Frame ChosenBodies::part_of(Frame frame, const std::unordered_set<std::int64_t>& boundary) const {
  if (all_) return frame;
  FrameBodies& b = frame.bodies;
  std::unordered_set<std::int64_t> kept;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (!holds(b, i)) continue;
    kept.insert(b.id[i]);
    rows.push_back(i);
  }
  take_rows(b, rows);
  FrameContacts& c = frame.contacts;
  rows.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const bool a = kept.contains(c.body_a[i]), other = kept.contains(c.body_b[i]);
    if ((a && other) || (a && boundary.contains(c.body_b[i])) || (other && boundary.contains(c.body_a[i]))) rows.push_back(i);
  }
  take_rows(c, rows);
  return frame;
}

}  // namespace scree
