#include <algorithm>
#include <cmath>

#include "decomposer/case/case_sections.hpp"

namespace scree {

namespace {

// Shares typed with a few digits.
constexpr double kShareTolerance = 1e-6;

void check_sieve(const CaseTable& t, SizeDistribution& d) {
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
    throw t.error("passing", fmt::format("goes from {:g} to {:g}; expected 0 at the finest sieve and 1 at the coarsest", d.passing.front(),
                                         d.passing.back()));
  }
  d.passing.back() = 1;
  d.min = d.sieve.front();
  d.max = d.sieve.back();
}

void size_section(CaseKeys& k, SizeDistribution& d) {
  using Kind = SizeDistribution::Kind;
  // each kind of distribution needs keys of its own
  const auto needed = [](const char* name, const char* when) { return Key{name, when, "", {}, true}; };
  const auto length_key = [&](const Key& key, double& value) { k.number(key, value, Dimension::length, Range::positive); };
  k.word({"distribution", kRequired, ""}, d.kind);
  const auto when = [&](Kind kind) { return k.when(d.kind == kind); };
  if (when(Kind::fixed)) {
    length_key(needed("diameter", "required for `fixed` and `sieve`"), d.first);
    d.min = d.max = d.first;
  }
  if (when(Kind::sieve)) {
    d.by_mass = true;
    k.numbers(needed("diameter", ""), d.sieve, Dimension::length);
    k.numbers(needed("passing", "required for `sieve`"), d.passing, Dimension::none);
    if (k.table() != nullptr) check_sieve(*k.table(), d);
  }
  if (when(Kind::normal)) {
    length_key(needed("mean", "required for `normal`"), d.first);
    length_key(needed("sigma", "required for `normal` and `lognormal`"), d.second);
  }
  if (when(Kind::lognormal)) {
    length_key(needed("median", "required for `lognormal`"), d.first);
    k.number(needed("sigma", ""), d.second, Dimension::none, Range::positive);
  }
  if (when(Kind::weibull)) {
    length_key(needed("scale", "required for `weibull`"), d.first);
    k.number(needed("shape", "required for `weibull`"), d.second, Dimension::none, Range::positive);
  }
  if (when(Kind::power)) k.number(needed("exponent", "required for `power`"), d.first, Dimension::none, Range::any);
  const bool is_truncated = d.kind != Kind::fixed && d.kind != Kind::sieve;
  if (k.when(is_truncated)) {
    ShareOf by = ShareOf::number;
    k.word({"by", "", "what the shares are of"}, by);
    d.by_mass = by == ShareOf::mass;
    // without bounds a tail asks, sooner or later, for a body larger than the box
    length_key(needed("min", "required, but for `fixed` and `sieve`"), d.min);
    length_key(needed("max", "required, but for `fixed` and `sieve`"), d.max);
  }
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  if (is_truncated && !(d.min <= d.max)) throw t->error("min", "must not be above max");
  if (is_truncated && d.min < d.max && !std::isfinite(d.share(0.5 * (d.min + d.max)))) {
    throw t->error("distribution", "has no sizes between min and max");
  }
  for (const std::string& key : k.left_over()) {
    throw t->error(key, fmt::format("is not part of a {} distribution", word_of(d.kind)));
  }
}

void alignment_section(CaseKeys& k, BodyOrientation& o) {
  const CaseTable* t = k.table();
  const bool is_list = t != nullptr && t->is_list("axis");
  o.kind = BodyOrientation::Kind::aligned;
  k.direction({"align", kRequired, "where an axis of the body points"}, o.direction);
  if (k.when(!is_list)) k.word({"axis", "", "which axis, or `[x, y, z]` in mesh axes"}, o.axis);
  if (k.when(is_list)) {
    k.direction({"axis"}, o.body_axis);
    if (is_list) o.axis = BodyOrientation::Axis::given;
  }
  k.number({"scatter", "", "deviation of the tilt about each of the two directions across"}, o.scatter, Dimension::angle,
           Range::not_negative);
}

}  // namespace

void size_key(CaseKeys& k, std::optional<SizeDistribution>& size) {
  const CaseTable* t = k.table();
  const bool is_table = t != nullptr && t->is_table("size");
  SizeDistribution d;
  if (k.when(!is_table)) {
    k.number({"size", "as in the file", "diameter of the sphere of equal volume"}, d.first, Dimension::length, Range::positive);
    d.min = d.max = d.first;
  }
  if (k.when(is_table)) {
    d.first = 0;
    k.section({"size"}, [&](CaseKeys& below) { size_section(below, d); });
  }
  if (t != nullptr && t->has("size")) size = d;
}

/// Shares of a mixture: fractions that add up to 1, or a ratio of whole numbers.
void share_keys(CaseKeys& k, const std::vector<std::string>& shapes, CaseSource& p) {
  ShareOf by = ShareOf::number;
  std::int32_t shape = 0;
  std::vector<std::pair<std::string, double>> shares;
  k.word({"shares_by", "", "what the shares are of; met to one body"}, by);
  const bool is_one = k.one_of({"shapes", "shape"}) == "shape";
  k.named_numbers({"shapes", "or `shape`", "`{ NAME = share, ... }`: shares that add up to 1, or a ratio of whole numbers"}, shares,
                  Range::positive);
  k.reference({"shape", "or `shapes`"}, shape, shapes, "shape");
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  p.shares_by_mass = by == ShareOf::mass;
  if (is_one) {
    if (t->has("shares_by")) throw t->error("shares_by", "is for a mixture: shapes = { a = 0.7, b = 0.3 }");
    p.shares = {{shape, 1.0}};
    return;
  }
  double sum = 0;
  bool whole = true;
  for (const auto& [name, share] : shares) {
    p.shares.emplace_back(t->find_name("shapes", name, shapes, "shape"), share);
    sum += share;
    whole = whole && share == std::floor(share);
  }
  if (!whole && std::abs(sum - 1) > kShareTolerance) {
    throw t->error("shapes", fmt::format("the shares add up to {:g}; expected 1, or a ratio of whole numbers such as 2 to 1", sum));
  }
  for (auto& share : p.shares) share.second /= sum;
}

void orientation_key(CaseKeys& k, BodyOrientation& o) {
  const CaseTable* t = k.table();
  const bool is_list = t != nullptr && t->is_list("orientation"), is_table = t != nullptr && t->is_table("orientation");
  if (k.when(!is_list && !is_table)) {
    k.only_word(
        {"orientation", "`random`, uniform", "the same for all, or an axis in a direction; about that axis bodies are turned at random"},
        "random");
  }
  if (k.when(is_list)) {
    k.orientation({"orientation"}, o.given);
    if (is_list) o.kind = BodyOrientation::Kind::given;
  }
  if (k.when(is_table)) k.section({"orientation"}, [&](CaseKeys& below) { alignment_section(below, o); });
}

void refuse_without_heat(const CaseKeys& k, const Case& c, std::initializer_list<const char*> keys) {
  const CaseTable* t = k.table();
  if (t == nullptr || c.settings.heat) return;
  for (const char* key : keys)
    if (t->has(key)) throw t->error(key, fmt::format("is for scenes with heat; add a table [heat], or leave {} out", key));
}

void temperature_key(CaseKeys& k, const Case& c, double& temperature) {
  k.number({"temperature", "that of `[heat]`", "with `[heat]`: of each body at its start"}, temperature, Dimension::temperature,
           Range::positive);
  refuse_without_heat(k, c, {"temperature"});
  const CaseTable* t = k.table();
  if (t == nullptr || !c.settings.heat) return;
  if (!(temperature > 0)) temperature = c.settings.heat->temperature;
  if (!(temperature > 0))
    throw t->error("temperature", "is missing; expected a temperature such as \"293 K\" here, or one for all bodies in [heat]");
}

void over_time_key(CaseKeys& k, const Key& key, const char* since, const char* column, const char* words, Dimension dimension, Range range,
                   TimeTable& values) {
  const CaseTable* t = k.table();
  const bool is_given = t != nullptr && t->has(key.name), is_table = is_given && t->is_table(key.name);
  if (k.when(!is_table)) {
    double number = values.value.empty() ? 0 : values.value.front();
    k.number(key, number, dimension, range);
    if (is_given) values = TimeTable::constant(number);
  }
  if (!k.when(is_table)) return;
  TimeTable table;
  k.section(key, [&](CaseKeys& below) {
    below.numbers({"time", kRequired, since}, table.time, Dimension::time);
    below.numbers({column, kRequired, "linear in between, and as in the first and last row before and after"}, table.value, dimension);
  });
  if (t == nullptr) return;
  if (const auto fault = table.fault(words)) throw t->error(key.name, *fault);
  values = table;
}

void heat_source_key(CaseKeys& k, Case& c, double& power, std::int32_t& table) {
  TimeTable values = TimeTable::constant(0);
  over_time_key(k, {"heat_source", "0", "power given to each body, with `[heat]`; below 0: taken from it; or a table"},
                "of the run, ascending", "power", "powers", Dimension::power, Range::any, values);
  refuse_without_heat(k, c, {"heat_source"});
  if (k.table() == nullptr || !c.settings.heat) return;
  if (values.is_constant()) {
    power = values.value.front();
    return;
  }
  table = static_cast<std::int32_t>(c.settings.heat->source_tables.size());
  c.settings.heat->source_tables.push_back(values);
}

void region_section(CaseKeys& k, const Case& c, CaseRegion& region) {
  std::vector<std::string> walls;
  for (const CaseWall& w : c.walls) walls.push_back(w.wall.name);
  Wall box;
  box.kind = WallKind::box_inside;
  const std::string kind = k.one_of({"box", "cylinder", "sphere", "inside", "inside_wall"});
  k.corners({"box"}, box.lower, box.upper);
  if (kind == "box") region.shape = box;
  k.section({"cylinder"}, [&](CaseKeys& below) { cylinder_keys(below, region.shape.emplace()); });
  k.section({"sphere"}, [&](CaseKeys& below) { sphere_keys(below, region.shape.emplace()); });
  k.path({"inside", "", "a closed mesh"}, region.file);
  k.reference({"inside_wall", "", "what a wall of that name holds, with its openings closed; one from a file must be closed"}, region.wall,
              walls, "wall named");
  const CaseTable* t = k.table();
  if (t == nullptr || kind != "inside_wall") return;
  const CaseWall& w = c.walls[static_cast<std::size_t>(region.wall)];
  if (w.wall.kind == WallKind::plane || (w.form && w.form->inside.triangles.empty())) {
    throw t->error("inside_wall", "this wall has no inside; name a box, cylinder, cone, sphere, hopper, drum or trough");
  }
}

namespace {

void amount_keys(CaseKeys& k, CasePopulation& p) {
  std::int64_t count = 0;
  double mass = 0, solid_fraction = 0;
  bool fill = false;
  const std::string amount = k.one_of({"count", "mass", "solid_fraction", "fill"});
  k.integer({"count", "one of `count`, `mass`, `solid_fraction`, `fill`", "how many, at least one of each shape"}, count, 1);
  k.number({"mass", "see `count`", "of all"}, mass, Dimension::mass, Range::positive);
  k.number({"solid_fraction", "see `count`", "share of the region's volume"}, solid_fraction, Dimension::none, Range::fraction);
  k.boolean({"fill", "see `count`", "`true`, with `method = \"settle\"`: until no more fits"}, fill);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  if (amount == "count") p.value = static_cast<double>(count);
  if (amount == "mass") {
    p.amount = CasePopulation::Amount::mass;
    p.value = mass;
  }
  if (amount == "solid_fraction") {
    p.amount = CasePopulation::Amount::solid_fraction;
    p.value = solid_fraction;
  }
  if (amount == "fill") {
    if (!fill) throw t->error("fill", "must be true; leave it out and give count, mass or solid_fraction");
    if (p.method != PackingMethod::settle) throw t->error("fill", "is for method = \"settle\": it pours until no more fits");
    p.amount = CasePopulation::Amount::fill;
    constexpr double kMoreThanFits = 0.85;  // of the region: no poured bed is as dense
    p.value = kMoreThanFits;
  }
}

void population_section(CaseKeys& k, Case& c) {
  CasePopulation p;
  const CaseTable* t = k.table();
  if (t != nullptr) p.where = t->where();
  share_keys(k, names_of_shapes(c), p);
  k.reference({"material", kRequired}, p.material, names_of_materials(c), "material");
  k.word({"method", "", "see the table below"}, p.method);
  if (t != nullptr && t->has("jitter") && p.method != PackingMethod::lattice) throw t->error("jitter", "is for method = \"lattice\"");
  k.number({"jitter", "", "0 to 1, of `lattice`: share of the free room of a cell in which the body lies at random"}, p.jitter,
           Dimension::none, Range::not_negative);
  if (p.jitter > 1) throw t->error("jitter", "expected a value from 0 to 1");
  amount_keys(k, p);
  size_key(k, p.size);
  k.section({"region", kRequired, "holds the bodies wholly, by the surface that touches: sharp corners of the drawn one may stick out"},
            [&](CaseKeys& below) { region_section(below, c, p.region); });
  orientation_key(k, p.orientation);
  k.vector({"velocity", "", "of all"}, p.velocity, Dimension::velocity);
  k.vector({"angular_velocity", "", "of all"}, p.angular_velocity, Dimension::angular_velocity);
  temperature_key(k, c, p.temperature);
  heat_source_key(k, c, p.heat_source, p.heat_table);
  if (t != nullptr) c.populations.push_back(p);
}

}  // namespace

void population_sections(CaseKeys& k, Case& c) {
  k.sections({"populations"}, [&](CaseKeys& below) { population_section(below, c); });
}

}  // namespace scree
