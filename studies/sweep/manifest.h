#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/base/input_file.h"

namespace gladstone {

/// What an axis of a study is set to in a case.
struct ParameterValue {
  std::string label;             ///< as shown: a number, a text, or the label that the study gives
  std::optional<double> number;  ///< where the value is a number, in the key's own unit

  /// Whether the study calls a number something else than the number.
  bool has_own_label() const;
};

/// How a number is shown that has no label of its own.
std::string number_label(double number);

/// One case of a study: one line of RUN/manifest.jsonl, on which alone its result depends.
struct ManifestCase {
  std::size_t index = 0;                                           ///< from 0, the line less one
  std::size_t repeat = 0;                                          ///< from 0; repeats have other dots, rays and noise
  std::uint64_t seed = 0;                                          ///< of the repeat; equal for all points of the study
  std::string device;                                              ///< "cpu" or "cuda": who may compute it
  std::vector<std::pair<std::string, ParameterValue>> parameters;  ///< by axis key path, in the study's order
  std::string setup;                          ///< full setup (TOML), file names absolute, every "auto" still one
  std::map<std::string, std::string> inputs;  ///< absolute name of every file that the setup names, and its file_hash()
  std::string line_hash;                      ///< content_hash() of the line without its last member, which it is

  /// "case 17 (lens.f_number = 8, geometry.z_d_mm = 250)"
  std::string title() const;
};

/// The names of what stands in a RUN folder.
namespace run_file {
inline constexpr char const* manifest = "manifest.jsonl";
inline constexpr char const* study = "study.toml";  ///< copy of the study file
inline constexpr char const* base = "base.toml";    ///< the setup that every case starts from, file names absolute
inline constexpr char const* claims = "claims";     ///< locked byte by byte by who computes which case
inline constexpr char const* cases = "cases";       ///< folder of results, INDEX.json
inline constexpr char const* table = "study.h5";
inline constexpr char const* table_text = "study.csv";
inline constexpr char const* points_text = "study_points.csv";
}  // namespace run_file

inline constexpr int manifest_version = 2;

/// The text of a case's line, without line end. Equal cases give equal text. Its last member is the line_hash.
std::string manifest_line(ManifestCase const& one);

/// The line_hash of a line.
std::string hash_of_line(std::string_view line);

/// The version of the manifest that a file's first line begins; nothing where it is no gladstone manifest.
std::optional<int> version_of_manifest(InputFile const& file);

/// RUN/manifest.jsonl, which is not held in memory: a case is read and parsed when it is asked for. Of many workers
/// each needs some cases only, and who looks at results needs no more than the hashes of their lines.
class Manifest {
 public:
  /// Reads the file through for its lines. It must stay as it is; another may take its place.
  /// @throws DataError at manifest.jsonl:LINE for a foreign or damaged file, a line cut short, out of order or of
  /// another version
  explicit Manifest(std::string const& path);

  std::size_t size() const { return ends_.size(); }
  /// @throws DataError where the line is not what was planned, by its hash, or has none
  ManifestCase operator[](std::size_t index) const;
  /// Of the line as it stands, whatever hash it holds.
  std::string line_hash(std::size_t index) const;

 private:
  std::string line(std::size_t index) const;

  InputFile file_;
  std::vector<std::uint64_t> ends_;  ///< of every line, before its line end
};

/// Reads RUN/manifest.jsonl. @throws DataError as Manifest, and where there is none
Manifest read_manifest(std::string const& run);

}  // namespace gladstone
