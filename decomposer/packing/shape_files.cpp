#include "decomposer/packing/shape_files.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/base/error.hpp"
#include "core/base/near_file.hpp"

namespace scree {

const ShapeFile& ShapeFiles::open(const std::string& file, const std::string& where) {
  const auto found = files_.find(file);
  if (found != files_.end()) return found->second;
  try {
    ShapeFile content = read_shape_file(file);
    inputs_.push_back({file, sha256_of_file(file), content.provenance});
    return files_.emplace(file, std::move(content)).first->second;
  } catch (const InputError& e) {
    const bool is_told = !file.ends_with(".h5") || (!std::filesystem::exists(file) && !near_file(file).empty());
    throw InputError("{}: {}{}", where, e.what(), is_told ? "" : "; make it with scree-mesher import");
  }
}

Shape ShapeFiles::body_shape(const CaseShape& s) {
  if (s.file.empty()) return make_sphere(s.name, s.sphere_radius);
  const ShapeFile& file = open(s.file, s.where);
  std::string names;
  for (const Shape& shape : file.shapes) {
    if (file.shapes.size() == 1 && s.name_in_file.empty()) {
      if (shape.kind == ShapeKind::surface) {
        throw InputError("{}: {} is a wall surface without mass; import it without --surface to use it as a body", s.where, s.file);
      }
    } else if (shape.name != s.name_in_file) {
      names += (names.empty() ? "" : ", ") + shape.name;
      continue;
    }
    Shape result = shape;
    result.name = s.name;
    return result;
  }
  if (!s.name_in_file.empty()) throw UsageError("{}: {} has no shape '{}'; it has: {}", s.where, s.file, s.name_in_file, names);
  throw UsageError("{}: {} holds {} shapes ({}); say which with name = \"...\"", s.where, s.file, file.shapes.size(), names);
}

const Shape& ShapeFiles::wall_shape(const CaseWall& wall) {
  const ShapeFile& file = open(wall.file, wall.where);
  if (file.shapes.size() != 1) {
    throw InputError("{}: {} holds {} shapes; a wall is made of one", wall.where, wall.file, file.shapes.size());
  }
  const Shape& shape = file.shapes.front();
  if (shape.kind == ShapeKind::sphere) throw InputError("{}: {} is an analytic sphere; use a fixed body", wall.where, wall.file);
  return shape;
}

std::vector<bool> used_shapes(const Case& c) {
  std::vector<bool> used(c.shapes.size(), false);
  for (const CaseBody& b : c.bodies) used[static_cast<std::size_t>(b.shape)] = true;
  for (const CasePopulation& p : c.populations) {
    for (const auto& share : p.shares) used[static_cast<std::size_t>(share.first)] = true;
  }
  for (const CaseInlet& i : c.inlets) {
    for (const auto& share : i.shares) used[static_cast<std::size_t>(share.first)] = true;
  }
  return used;
}

std::vector<std::string> check_shape_files(const Case& c) {
  ShapeFiles files;
  std::vector<std::string> missing;
  const auto is_there = [&](const std::string& file, const std::string& where) {
    if (std::filesystem::exists(file)) return true;
    missing.push_back(fmt::format("{} ({})", file, where));
    return false;
  };
  const std::vector<bool> used = used_shapes(c);
  for (std::size_t i = 0; i < c.shapes.size(); ++i) {
    const CaseShape& s = c.shapes[i];
    if (!used[i]) continue;
    if (!s.file.empty() && is_there(s.file, s.where)) files.body_shape(s);
    if (!s.pieces.empty() && is_there(s.pieces, s.where)) files.open(s.pieces, s.where);
  }
  for (const CaseWall& wall : c.walls) {
    if (wall.wall.kind == WallKind::mesh && !wall.form && is_there(wall.file, wall.where)) files.wall_shape(wall);
  }
  const auto check_region = [&](const CaseRegion& region, const std::string& where) {
    if (!region.shape && region.wall < 0 && is_there(region.file, where)) files.open(region.file, where);
  };
  for (const CasePopulation& p : c.populations) check_region(p.region, p.where);
  for (const CaseInlet& i : c.inlets) check_region(i.region, i.where);
  for (const CaseOutlet& o : c.outlets) check_region(o.region, o.where);
  return missing;
}

}  // namespace scree
