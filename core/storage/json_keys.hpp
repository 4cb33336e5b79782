// Reads keys from the JSON text of a scene file, and writes them there.
#pragma once

#include <nlohmann/json.hpp>

#include "core/storage/json_object.hpp"
#include "core/storage/keys.hpp"

namespace scree {

nlohmann::json to_json(const Vec3& v);
nlohmann::json to_json(const Quat& q);

class JsonKeyWriter : public KeyVisitor {
 public:
  explicit JsonKeyWriter(nlohmann::json& object) : object_(object) {}
  void number(const Key& key, double& value, Dimension dimension, Range range) override;
  void count(const Key& key, std::uint64_t& value) override;
  void boolean(const Key& key, bool& value) override;
  void text(const Key& key, std::string& value) override;
  void vector(const Key& key, Vec3& value, Dimension dimension) override;
  void direction(const Key& key, Vec3& value) override;
  void velocity(const Key& key, double& speed, Vec3& direction) override;
  void numbers(const Key& key, std::vector<double>& values, Dimension dimension) override;
  void vectors(const Key& key, std::vector<Vec3>& values, Dimension dimension) override;
  void axes(const Key& key, std::array<bool, 3>& value) override;

 protected:
  void choose(const Key& key, std::size_t& index, const std::vector<std::string>& words) override;

 private:
  nlohmann::json& object_;
};

/// Throws InputError, as JsonObject does, where a value is missing or cannot be right. A value that is the default is in range: files
/// write it where the case gave none.
class JsonKeyReader : public KeyVisitor {
 public:
  explicit JsonKeyReader(const JsonObject& object) : object_(object) {}
  void number(const Key& key, double& value, Dimension dimension, Range range) override;
  void count(const Key& key, std::uint64_t& value) override;
  void boolean(const Key& key, bool& value) override;
  void text(const Key& key, std::string& value) override;
  void vector(const Key& key, Vec3& value, Dimension dimension) override;
  void direction(const Key& key, Vec3& value) override;
  void velocity(const Key& key, double& speed, Vec3& direction) override;
  void numbers(const Key& key, std::vector<double>& values, Dimension dimension) override;
  void vectors(const Key& key, std::vector<Vec3>& values, Dimension dimension) override;
  void axes(const Key& key, std::array<bool, 3>& value) override;

 protected:
  void choose(const Key& key, std::size_t& index, const std::vector<std::string>& words) override;

 private:
  bool is_there(const Key& key) const;

  const JsonObject& object_;
};

}  // namespace scree
