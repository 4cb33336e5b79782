#include "core/base/json_record.hpp"

#include <nlohmann/json.hpp>

namespace scree {

JsonRecord::JsonRecord() = default;
JsonRecord::JsonRecord(const nlohmann::json& value) : value_(std::make_unique<nlohmann::json>(value)) {}
JsonRecord::JsonRecord(const JsonRecord& other)
    : value_(other.value_ == nullptr ? nullptr : std::make_unique<nlohmann::json>(*other.value_)) {}
JsonRecord::JsonRecord(JsonRecord&& other) noexcept = default;
JsonRecord& JsonRecord::operator=(const JsonRecord& other) {
  if (this != &other) *this = JsonRecord(other);
  return *this;
}
JsonRecord& JsonRecord::operator=(JsonRecord&& other) noexcept = default;
JsonRecord::~JsonRecord() = default;

const nlohmann::json& JsonRecord::operator*() const {
  static const nlohmann::json kNull;
  return value_ == nullptr ? kNull : *value_;
}

nlohmann::json& JsonRecord::operator*() {
  if (value_ == nullptr) value_ = std::make_unique<nlohmann::json>();
  return *value_;
}

bool operator==(const JsonRecord& a, const JsonRecord& b) { return *a == *b; }

}  // namespace scree
