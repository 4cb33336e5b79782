#include <algorithm>
#include <cmath>
#include <tuple>

#include "decomposer/case/case_sections.hpp"

namespace scree {

namespace {

// Shares typed with a few digits.
constexpr double kShareTolerance = 1e-6;

SizeDistribution read_size(const CaseTable& population) {
  SizeDistribution d;
  const auto fixed = [&](double diameter) { d.first = d.min = d.max = diameter; };
  const std::vector<std::string> keys = {"distribution", "by",    "diameter", "mean", "median", "sigma",
                                         "scale",        "shape", "exponent", "min",  "max",    "passing"};
  if (!population.is_table("size")) {
    fixed(population.number("size", Dimension::length, Range::positive));
    return d;
  }
  const CaseTable t = population.table("size", keys);
  const std::string kind = t.text("distribution");
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
  } else if (kind == "sieve") {
    d.kind = SizeDistribution::Kind::sieve;
    d.by_mass = true;
    used.insert(used.end(), {"diameter", "passing"});
    d.sieve = t.numbers("diameter", Dimension::length);
    d.passing = t.numbers("passing", Dimension::none);
    if (d.sieve.size() != d.passing.size() || d.sieve.size() < 2) {
      throw t.error("passing",
                    fmt::format("has {} values for {} diameters; expected as many, and at least two", d.passing.size(), d.sieve.size()));
    }
    for (std::size_t i = 0; i < d.sieve.size(); ++i) {
      if (!(d.sieve[i] > (i == 0 ? 0 : d.sieve[i - 1]))) throw t.error("diameter", "must be > 0 and ascend");
      if (i > 0 && !(d.passing[i] >= d.passing[i - 1]))
        throw t.error("passing", "must not descend: it is the share of the mass that is finer");
    }
    if (d.passing.front() != 0 || std::abs(d.passing.back() - 1) > kShareTolerance) {
      throw t.error("passing", fmt::format("goes from {:g} to {:g}; expected 0 at the finest sieve and 1 at the coarsest",
                                           d.passing.front(), d.passing.back()));
    }
    d.passing.back() = 1;
    d.min = d.sieve.front();
    d.max = d.sieve.back();
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
      t.word_or("distribution", d.kind);
      throw UsageError("{}: expected a distribution, for instance {{ distribution = \"uniform\", min = \"8 mm\", max = \"20 mm\" }}",
                       t.where());
    }
    used.emplace_back("by");
    d.by_mass = t.word_or("by", ShareOf::number) == ShareOf::mass;
    // without bounds a tail asks, sooner or later, for a body larger than the box
    d.min = length_of("min");
    d.max = length_of("max");
    if (!(d.min <= d.max)) throw t.error("min", "must not be above max");
    if (d.min < d.max && !std::isfinite(d.share(0.5 * (d.min + d.max)))) throw t.error("distribution", "has no sizes between min and max");
  }
  for (const std::string& key : keys) {
    if (t.has(key) && std::find(used.begin(), used.end(), key) == used.end()) {
      throw t.error(key, fmt::format("is not part of a {} distribution", kind));
    }
  }
  return d;
}

/// Shares of a mixture: fractions that add up to 1, or a ratio of whole numbers.
void read_shares(const CaseTable& t, const std::vector<std::string>& shapes, CasePopulation& p) {
  p.shares_by_mass = t.word_or("shares_by", ShareOf::number) == ShareOf::mass;
  if (t.only_one_of({"shapes", "shape"}) == "shape") {
    if (t.has("shares_by")) throw t.error("shares_by", "is for a mixture: shapes = { a = 0.7, b = 0.3 }");
    p.shares = {{t.reference("shape", shapes, "shape"), 1.0}};
    return;
  }
  double sum = 0;
  bool whole = true;
  for (const auto& [name, share] : t.named_numbers("shapes", Range::positive)) {
    p.shares.emplace_back(t.find_name("shapes", name, shapes, "shape"), share);
    sum += share;
    whole = whole && share == std::floor(share);
  }
  if (!whole && std::abs(sum - 1) > kShareTolerance) {
    throw t.error("shapes", fmt::format("the shares add up to {:g}; expected 1, or a ratio of whole numbers such as 2 to 1", sum));
  }
  for (auto& share : p.shares) share.second /= sum;
}

CaseOrientation read_population_orientation(const CaseTable& t) {
  CaseOrientation o;
  if (!t.has("orientation")) return o;
  if (t.is_list("orientation")) {
    o.kind = CaseOrientation::Kind::given;
    o.given = read_orientation(t);
    return o;
  }
  if (!t.is_table("orientation")) {
    t.word("orientation", {"random"});
    return o;
  }
  const CaseTable a = t.table("orientation", {"align", "axis", "scatter"});
  o.kind = CaseOrientation::Kind::aligned;
  o.direction = a.direction("align");
  if (a.is_list("axis")) {
    o.axis = CaseOrientation::Axis::given;
    o.body_axis = a.direction("axis");
  } else {
    o.axis = a.word_or("axis", o.axis);
  }
  o.scatter = a.number_or("scatter", Dimension::angle, 0, Range::not_negative);
  return o;
}

void read_amount(const CaseTable& t, CasePopulation& p) {
  const std::string amount = t.only_one_of({"count", "mass", "solid_fraction", "fill"});
  if (amount == "count") p.value = static_cast<double>(t.integer("count", 1));
  if (amount == "mass") {
    p.amount = CasePopulation::Amount::mass;
    p.value = t.number("mass", Dimension::mass, Range::positive);
  }
  if (amount == "solid_fraction") {
    p.amount = CasePopulation::Amount::solid_fraction;
    p.value = t.number("solid_fraction", Dimension::none, Range::fraction);
  }
  if (amount == "fill") {
    if (!t.boolean_or("fill", false)) throw t.error("fill", "must be true; leave it out and give count, mass or solid_fraction");
    if (p.method != PackingMethod::settle) throw t.error("fill", "is for method = \"settle\": it pours until no more fits");
    p.amount = CasePopulation::Amount::fill;
    constexpr double kMoreThanFits = 0.85;  // of the region: no poured bed is as dense
    p.value = kMoreThanFits;
  }
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
  for (const CaseTable& t :
       top.tables("populations", {"shapes", "shape", "material", "count", "mass", "solid_fraction", "fill", "size", "region", "method",
                                  "jitter", "shares_by", "orientation", "velocity", "angular_velocity"})) {
    CasePopulation p;
    p.where = t.where();
    read_shares(t, shapes, p);
    p.material = t.reference("material", materials, "material");
    p.method = t.word_or("method", p.method);
    if (t.has("jitter") && p.method != PackingMethod::lattice) throw t.error("jitter", "is for method = \"lattice\"");
    p.jitter = t.number_or("jitter", Dimension::none, p.jitter, Range::not_negative);
    if (p.jitter > 1) throw t.error("jitter", "expected a value from 0 to 1");
    read_amount(t, p);
    if (t.has("size")) p.size = read_size(t);
    p.region = read_region(t, folder, c);
    p.orientation = read_population_orientation(t);
    p.velocity = t.vector_or("velocity", Dimension::velocity, {});
    p.angular_velocity = t.vector_or("angular_velocity", Dimension::angular_velocity, {});
    c.populations.push_back(p);
  }
}

}  // namespace scree
