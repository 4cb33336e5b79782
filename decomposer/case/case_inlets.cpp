// Where bodies come in and go out while a run goes on.
#include "decomposer/case/case_sections.hpp"

namespace scree {

namespace {

/// A name that messages and tables use: unique among those of its kind.
template <class Item>
void name_key(CaseKeys& k, const char* kind, const std::vector<Item>& others, std::string& name) {
  name = fmt::format("{} {}", kind, others.size());
  k.text({"name", "kind and number", "for messages and tables"}, name);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  if (name.empty()) throw t->error("name", "must not be empty");
  for (const Item& other : others) {
    if (other.name == name) throw t->error("name", fmt::format("is the name of {} as well; names must differ", other.where));
  }
}

void rate_keys(CaseKeys& k, FeedRate& rate) {
  const std::string given = k.one_of({"rate", "number_rate"});
  rate.by_number = given == "number_rate";
  const auto rate_key = [&](const Key& key, Dimension dimension) {
    over_time_key(k, key, "from `start`, ascending", "rate", "rates", dimension, Range::positive, rate.rate);
  };
  rate_key({"rate", "or `number_rate`", "mass per time, or a table"}, Dimension::mass_rate);
  rate_key({"number_rate", "or `rate`", "bodies per time, or a table"}, Dimension::frequency);
  if (k.table() == nullptr) return;
  if (const auto fault = rate.fault()) throw k.table()->error(given, *fault);
}

void inlet_section(CaseKeys& k, Case& c) {
  CaseInlet i;
  const CaseTable* t = k.table();
  if (t != nullptr) i.where = t->where();
  Inlet& inlet = i.inlet;
  name_key(k, "inlet", c.inlets, i.name);
  share_keys(k, names_of_shapes(c), i);
  k.reference({"material", kRequired}, i.material, names_of_materials(c), "material");
  size_key(k, i.size);
  k.section({"region", kRequired, "holds each body wholly as it comes in; does not move, not even with a wall"},
            [&](CaseKeys& below) { region_section(below, c, i.region); });
  orientation_key(k, i.orientation);
  k.vector({"velocity", "", "with which bodies come in"}, i.velocity, Dimension::velocity);
  k.vector({"angular_velocity", "", "the same"}, i.angular_velocity, Dimension::angular_velocity);
  temperature_key(k, c, i.temperature);
  rate_keys(k, inlet.rate);
  k.number({"start", "", "nothing comes before"}, inlet.start, Dimension::time, Range::any);
  k.number({"stop", "never", "no further body becomes due after"}, inlet.stop, Dimension::time, Range::any);
  k.number({"limit", "none", "of the mass of all"}, inlet.limit, Dimension::mass, Range::positive);
  k.integer({"count", "none", "of all"}, inlet.count, 1);
  k.word({"when_full", "",
          "if the next body finds no free place: the inlet waits, and the missing bodies come in as soon as there is space; or the run "
          "stops (exit 5)"},
         inlet.when_full);
  if (t == nullptr) return;
  if (!(inlet.start < inlet.stop)) throw t->error("stop", "must come after start");
  if (c.settings.stop_at_rest) {
    throw t->error("", "goes with time.stop_at_rest = false only: what rest is follows from bodies that are there from the start");
  }
  if (c.settings.stop_when_empty) {
    throw t->error("", "goes with time.stop_when_empty = false only: a run may be empty before its first body comes in");
  }
  c.inlets.push_back(i);
}

void outlet_section(CaseKeys& k, Case& c) {
  CaseOutlet o;
  std::vector<std::string> inlets;
  for (const CaseInlet& i : c.inlets) inlets.push_back(i.name);
  const CaseTable* t = k.table();
  if (t != nullptr) o.where = t->where();
  name_key(k, "outlet", c.outlets, o.name);
  k.section({"region", kRequired, "as of a population; does not move, not even with a wall"},
            [&](CaseKeys& below) { region_section(below, c, o.region); });
  k.reference({"to", "none", "name of an inlet through which bodies come in again, with their shape, size and id"}, o.to, inlets,
              "inlet named");
  if (t != nullptr) c.outlets.push_back(o);
}

}  // namespace

void inlet_sections(CaseKeys& k, Case& c) {
  k.sections({"inlets"}, [&](CaseKeys& below) { inlet_section(below, c); });
  k.sections({"outlets"}, [&](CaseKeys& below) { outlet_section(below, c); });
}

}  // namespace scree
