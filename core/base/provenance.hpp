// Where a file comes from: the record that opens every file that Scree writes.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/json_record.hpp"

namespace scree {

/// One input of a run: its name, its hash, and the provenance record it carried itself (null when none).
struct InputRecord {
  std::string path;
  std::string sha256;
  JsonRecord history;
};

/// The provenance record, made by each tool and written as JSON text (dataset or key "provenance").
struct Provenance {
  std::string format;  ///< for instance "scree-shape"
  std::int64_t format_version = 0;
  std::string tool;                  ///< "scree-mesher"
  std::vector<std::string> command;  ///< command line as given
  std::string configuration;         ///< the case file or the options as read
  std::vector<InputRecord> inputs;
  std::uint64_t seed = 0;
  int ranks = 1, threads = 1;
  std::string instruction_set;  ///< SIMD target in use; "scalar" when none
};

/// JSON with everything above and what the build knows: tool version, git hash and dirty flag, compiler, UTC time.
nlohmann::json provenance_record(const Provenance& provenance);

/// SHA-256 of a file, in hexadecimal. Throws SystemError when it cannot be read.
std::string sha256_of_file(const std::string& path);
/// SHA-256 of bytes in memory.
std::string sha256_of_bytes(const void* data, std::size_t size);

/// Now, as "2026-11-21T04:05:06Z".
std::string utc_now();

}  // namespace scree
