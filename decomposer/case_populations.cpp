#include <algorithm>
#include <cmath>
#include <tuple>

#include "decomposer/case_sections.hpp"

namespace scree {

namespace {

SizeDistribution read_size(const CaseTable& population) {
  SizeDistribution d;
  const auto fixed = [&](double diameter) { d.first = d.min = d.max = diameter; };
  const std::vector<std::string> keys = {"distribution", "diameter", "mean", "median", "sigma", "scale", "shape", "exponent", "min", "max"};
  if (!population.is_table("size")) {
    fixed(population.number("size", Dimension::length, Range::positive));
    return d;
  }
  const CaseTable t = population.table("size", keys);
  const std::string kind = t.has("distribution") ? t.text("distribution") : "";
  std::vector<std::string> used = {"distribution"};
  const auto length_of = [&](const char* key) {
    used.emplace_back(key);
    return t.number(key, Dimension::length, Range::positive);
  };
  const auto plain = [&](const char* key, Range range) {
    used.emplace_back(key);
    return t.number(key, Dimension::none, range);
  };
  if (kind == "fixed") {
    fixed(length_of("diameter"));
  } else {
    if (kind == "uniform") {
      d.kind = SizeDistribution::Kind::uniform;
    } else if (kind == "normal") {
      d.kind = SizeDistribution::Kind::normal;
      d.first = length_of("mean");
      d.second = length_of("sigma");
    } else if (kind == "lognormal") {
      d.kind = SizeDistribution::Kind::lognormal;
      d.first = length_of("median");
      d.second = plain("sigma", Range::positive);
    } else if (kind == "weibull") {
      d.kind = SizeDistribution::Kind::weibull;
      d.first = length_of("scale");
      d.second = plain("shape", Range::positive);
    } else if (kind == "power") {
      d.kind = SizeDistribution::Kind::power;
      d.first = plain("exponent", Range::any);
    } else {
      t.word_or("distribution", "", {"fixed", "uniform", "normal", "lognormal", "weibull", "power"}, {});
      throw UsageError("{}: expected a distribution, for instance {{ distribution = \"uniform\", min = \"8 mm\", max = \"20 mm\" }}",
                       t.where());
    }
    // without bounds a tail asks, sooner or later, for a body larger than the box
    d.min = length_of("min");
    d.max = length_of("max");
    if (!(d.min <= d.max)) throw t.error("min", "must not be above max");
    const auto share = [&](double u) { return d.quantile(u); };
    if (!std::isfinite(share(0.5))) throw t.error("distribution", "has no sizes between min and max");
  }
  for (const std::string& key : keys) {
    if (t.has(key) && std::find(used.begin(), used.end(), key) == used.end()) {
      throw t.error(key, fmt::format("is not part of a {} distribution", kind));
    }
  }
  return d;
}

CaseRegion read_region(const CaseTable& t, const std::string& folder, const Case& c) {
  CaseRegion region;
  const CaseTable r = t.table("region", {"box", "cylinder", "sphere", "inside", "inside_wall"});
  const std::string kind = r.only_one_of({"box", "cylinder", "sphere", "inside", "inside_wall"});
  if (kind == "inside") {
    region.file = resolved(folder, r.text("inside"));
  } else if (kind == "inside_wall") {
    std::vector<std::string> names;
    for (const CaseWall& w : c.walls) names.push_back(w.wall.name);
    region.wall = r.reference("inside_wall", names, "wall named");
    const CaseWall& w = c.walls[static_cast<std::size_t>(region.wall)];
    if (w.wall.kind == WallKind::plane || (w.form && w.form->inside.triangles.empty())) {
      throw r.error("inside_wall", "this wall has no inside; name a box, cylinder, cone, sphere, hopper or drum");
    }
    if (!w.file.empty()) throw r.error("inside_wall", "this wall is a file, which need not be closed; give region = { inside = \"FILE\" }");
  } else if (kind == "box") {
    region.shape.emplace();
    region.shape->kind = WallKind::box_inside;
    std::tie(region.shape->lower, region.shape->upper) = r.corners("box");
  } else if (kind == "cylinder") {
    read_cylinder(r.table(kind, {"start", "end", "radius"}), region.shape.emplace());
  } else {
    read_sphere(r.table(kind, {"centre", "radius"}), region.shape.emplace());
  }
  return region;
}

}  // namespace

void read_populations(const CaseTable& top, const std::string& folder, const std::vector<std::string>& shapes,
                      const std::vector<std::string>& materials, Case& c) {
  for (const CaseTable& t : top.tables("populations", {"shapes", "shape", "material", "count", "mass", "solid_fraction", "size",
                                                       "region", "method", "velocity", "angular_velocity"})) {
    CasePopulation p;
    p.where = t.where();
    if (t.only_one_of({"shapes", "shape"}) == "shape") {
      p.shares = {{t.reference("shape", shapes, "shape"), 1.0}};
    } else {
      double sum = 0;
      for (const auto& [name, share] : t.named_numbers("shapes", Range::positive)) {
        p.shares.emplace_back(t.find_name("shapes", name, shapes, "shape"), share);
        sum += share;
      }
      for (auto& share : p.shares) share.second /= sum;
    }
    p.material = t.reference("material", materials, "material");
    const std::string amount = t.only_one_of({"count", "mass", "solid_fraction"});
    if (amount == "count") p.value = static_cast<double>(t.integer("count", 0));
    if (amount == "mass") {
      p.amount = CasePopulation::Amount::mass;
      p.value = t.number("mass", Dimension::mass, Range::positive);
    }
    if (amount == "solid_fraction") {
      p.amount = CasePopulation::Amount::solid_fraction;
      p.value = t.number("solid_fraction", Dimension::none, Range::fraction);
    }
    if (t.has("size")) p.size = read_size(t);
    p.region = read_region(t, folder, c);
    t.word_or("method", "random", {"random", "lattice", "settle"}, {"random"});
    p.velocity = t.vector_or("velocity", Dimension::velocity, {});
    p.angular_velocity = t.vector_or("angular_velocity", Dimension::angular_velocity, {});
    c.populations.push_back(p);
  }
}

}  // namespace scree
