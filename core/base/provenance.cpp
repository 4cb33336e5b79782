#include "core/base/provenance.hpp"

#include <openssl/evp.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>

#include "core/base/error.hpp"
#include "core/base/utf8.hpp"
#include "core/base/version.hpp"

namespace scree {

namespace {

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
  void add(const void* data, std::size_t size) { EVP_DigestUpdate(context_.get(), data, size); }
  std::string hex() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), digest, &size);
    std::string text;
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

nlohmann::json provenance_record(const Provenance& p) {
  nlohmann::json record;
  record["format"] = p.format;
  record["format_version"] = p.format_version;
  record["tool"] = p.tool;
  record["tool_version"] = kVersion;
  record["git"] = kGitHash;
  record["git_dirty"] = kGitDirty;
  record["compiler"] = kCompiler;
  record["command"] = nlohmann::json::array();
  for (const std::string& word : p.command) record["command"].push_back(utf8_from_bytes(word));
  record["configuration"] = p.configuration;
  record["seed"] = p.seed;
  record["ranks"] = p.ranks;
  record["threads"] = p.threads;
  record["instruction_set"] = p.instruction_set;
  record["utc"] = utc_now();
  record["inputs"] = nlohmann::json::array();
  for (const InputRecord& input : p.inputs) {
    record["inputs"].push_back({{"path", utf8_from_bytes(input.path)}, {"sha256", input.sha256}, {"history", input.history}});
  }
  return record;
}

std::string sha256_of_file(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw SystemError("cannot read {}: {}", path, std::strerror(errno));
  Sha256 hash;
  std::vector<char> buffer(1 << 16);
  std::size_t size = 0;
  while ((size = std::fread(buffer.data(), 1, buffer.size(), file.get())) > 0) hash.add(buffer.data(), size);
  return hash.hex();
}

std::string sha256_of_bytes(const void* data, std::size_t size) {
  Sha256 hash;
  hash.add(data, size);
  return hash.hex();
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace scree
