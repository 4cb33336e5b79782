// A JSON value as a member of plain data. A header that holds one names the type alone: the JSON library, which costs the compiler most of
// a second a file, is read by the files that look inside.
#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>

namespace scree {

/// Copies deeply, as the value itself does. Moved from, it is null.
class JsonRecord {
 public:
  JsonRecord();                                 ///< null
  JsonRecord(std::nullptr_t) : JsonRecord() {}  // NOLINT(google-explicit-constructor): null
  JsonRecord(const nlohmann::json& value);      // NOLINT(google-explicit-constructor): a JSON value is what it is made of
  JsonRecord(const JsonRecord& other);
  JsonRecord(JsonRecord&& other) noexcept;
  JsonRecord& operator=(const JsonRecord& other);
  JsonRecord& operator=(JsonRecord&& other) noexcept;
  ~JsonRecord();

  const nlohmann::json& operator*() const;
  nlohmann::json& operator*();
  const nlohmann::json* operator->() const { return &**this; }
  nlohmann::json* operator->() { return &**this; }
  operator const nlohmann::json&() const { return **this; }  // NOLINT(google-explicit-constructor)

  friend bool operator==(const JsonRecord& a, const JsonRecord& b);

 private:
  std::unique_ptr<nlohmann::json> value_;  ///< null pointer: null
};

}  // namespace scree
