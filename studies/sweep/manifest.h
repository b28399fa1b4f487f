#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/files/input_file.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline sweep {

/// Value of a study's axis in a case.
struct ParameterValue {
  std::string label;             ///< displayed text: a number, a text, or the label in the study file
  std::optional<double> number;  ///< value in the unit of the key; nullopt if it is not a number

  /// Returns true if the study file defines a label for a number that differs from the number itself.
  bool has_own_label() const;
};

/// Formats a number that has no label in the study file.
std::string number_label(double number);

/// One case of a study: a line of RUN/manifest.jsonl, which determines its result completely.
struct ManifestCase {
  std::size_t index = 0;  ///< number of the case, from 0: line number - 1
  /// From 0; repeats differ in random dots, rays and noise.
  std::size_t repeat = 0;
  /// Seed of the repeat, equal for all points of the study.
  std::uint64_t seed = 0;
  /// "cpu" or "cuda": device that must compute the case.
  std::string device;
  std::vector<std::pair<std::string, ParameterValue>> parameters;  ///< values by key path of the axis, in the study's
                                                                   ///< order
  /// Complete setup (TOML) with absolute file names; "auto" values are not resolved.
  std::string setup;
  /// Parsed `setup`; null for a case that was read from a manifest.
  std::shared_ptr<SetupDocument const> document;
  std::map<std::string, std::string> inputs;  ///< file_hash() of every file in the setup, by its absolute name
  /// Hash, by content_hash(), of the line without its last member, which contains this hash.
  std::string line_hash;

  /// Returns a title for messages: "case 17 (lens.f_number = 8, geometry.z_d_mm = 250)"
  std::string title() const;
};

/// Names of the files in a RUN folder.
namespace run_file {
inline constexpr char const* manifest = "manifest.jsonl";
inline constexpr char const* study = "study.toml";  ///< copy of the study file
inline constexpr char const* base = "base.toml";    ///< base setup of all cases, with absolute file names
inline constexpr char const* claims = "claims";     ///< lock file, one byte per case, see CaseLocks
inline constexpr char const* cases = "cases";       ///< folder of the results INDEX.json
inline constexpr char const* table = "study.h5";
inline constexpr char const* table_text = "study.csv";
inline constexpr char const* points_text = "study_points.csv";
inline constexpr char const* job_files = "slurm/*";  ///< script and number of the job array, logs of its tasks
}  // namespace run_file

inline constexpr int manifest_version = 2;

/// Formats a case as a manifest line without line end; its last member is the line_hash. Equal cases give equal texts.
std::string manifest_line(ManifestCase const& one);

/// Computes the line_hash of a line.
std::string hash_of_line(std::string_view line);

/// Returns the manifest version from the first line of a file, or nullopt if it is not a gladstone manifest.
std::optional<int> read_manifest_version(InputFile const& file);

/// Index of RUN/manifest.jsonl, which is not held in memory: cases are read and parsed on access. Each of many workers
/// needs only some of the cases, and reading results requires only the hashes of the lines.
class Manifest {
 public:
  /// Scans the file for its lines. The file must not be modified afterwards, but may be replaced by another.
  /// @throws DataError at manifest.jsonl:LINE for a foreign or damaged file, or a line that is truncated, out of order
  ///         or of another version
  explicit Manifest(std::string const& path);

  std::size_t size() const { return ends_.size(); }
  /// Reads a case. @throws DataError if the line has no hash or does not match it
  ManifestCase operator[](std::size_t index) const;
  /// Returns the hash computed from the line's content, regardless of the hash stored in it.
  std::string line_hash(std::size_t index) const;

 private:
  std::string line(std::size_t index) const;

  InputFile file_;
  std::vector<std::uint64_t> ends_;  ///< offset of each line's end, excluding the line end character
};

/// Opens RUN/manifest.jsonl. @throws DataError as Manifest, and if the file does not exist
Manifest read_manifest(std::string const& run);

}  // namespace gladstone::inline sweep
