// The sections of a case: what keys each has, and what they must fulfil together. case_keys visits them all, in the order in which
// they are read.
#pragma once

#include <initializer_list>

#include "decomposer/case/case.hpp"
#include "decomposer/case/case_keys.hpp"

namespace scree {

/// The whole case language.
void case_keys(CaseKeys& k, Case& c);
std::vector<KeyDescription> describe_case();

/// title to [output]
void settings_sections(CaseKeys& k, Case& c);
/// [[walls]]
void wall_sections(CaseKeys& k, Case& c);
/// [[populations]]; after the walls, since a region may be the inside of one.
void population_sections(CaseKeys& k, Case& c);
/// [start]
void start_section(CaseKeys& k, Case& c);

/// [[inlets]] and [[outlets]]; after the walls as well
void inlet_sections(CaseKeys& k, Case& c);

/// [[bonds]]; after the shapes, whose pieces they hold
void bond_sections(CaseKeys& k, Case& c);

// What populations and inlets have in common.
void share_keys(CaseKeys& k, const std::vector<std::string>& shapes, CaseSource& source);
void size_key(CaseKeys& k, std::optional<SizeDistribution>& size);
void orientation_key(CaseKeys& k, BodyOrientation& orientation);
void region_section(CaseKeys& k, const Case& c, CaseRegion& region);

/// Throws UsageError for the first of these keys that a case without [heat] gives.
void refuse_without_heat(const CaseKeys& k, const Case& c, std::initializer_list<const char*> keys);
/// The temperature of bodies, of [heat] where they give none.
void temperature_key(CaseKeys& k, const Case& c, double& temperature);
/// Power given to each body; a table is added to those of [heat], and `table` is its index.
void heat_source_key(CaseKeys& k, Case& c, double& power, std::int32_t& table);
/// A number, or a table { time, `column` } of such numbers. `values` stays as it is where the key is absent.
///   in   since   the meaning of the times     in   words   what the values are, for messages     in   range   of a number; tables are for
///   the caller to check
void over_time_key(CaseKeys& k, const Key& key, const char* since, const char* column, const char* words, Dimension dimension, Range range,
                   TimeTable& values);

/// { start, end, radius } and { centre, radius }, into the fields of a wall of that kind.
void cylinder_keys(CaseKeys& k, Wall& wall);
void sphere_keys(CaseKeys& k, Wall& wall);

/// The shape of a wall, one of those that `[[walls]]` lists (case_forms.cpp).
void wall_shape_section(CaseKeys& k, CaseWall& w);

std::vector<std::string> names_of_shapes(const Case& c);
std::vector<std::string> names_of_materials(const Case& c);

}  // namespace scree
