#include "studies/sweep/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/files/content_hash.h"

namespace gladstone::inline sweep {
namespace {

using Json = nlohmann::ordered_json;

/// Formats a value as a text, a number, or {label, value} for a number with a label. JSON has no infinity, which
/// becomes a text.
Json value_json(ParameterValue const& value) {
  if (!value.number) return value.label;
  if (!value.has_own_label() && std::isfinite(*value.number)) return *value.number;
  Json const number = std::isfinite(*value.number) ? Json(*value.number) : Json(number_label(*value.number));
  return {{"label", value.label}, {"value", number}};
}

ParameterValue value_of(Json const& json) {
  if (json.is_string()) return {json.get<std::string>(), std::nullopt};
  if (json.is_number()) return {number_label(json.get<double>()), json.get<double>()};
  Json const& value = json.at("value");
  double const number =
      value.is_string() ? std::strtod(value.get_ref<std::string const&>().c_str(), nullptr) : value.get<double>();
  return {json.at("label").get<std::string>(), number};
}

constexpr std::string_view hash_start = ",\"hash\":\"";  // followed by 16 digits and `"}` at the end of every line
constexpr std::size_t hash_end_size = hash_start.size() + 16 + 2;

bool has_hash(std::string_view line) {
  return line.size() > hash_end_size && line.substr(line.size() - hash_end_size).starts_with(hash_start);
}

/// Returns nullopt if the object is not a case of a gladstone manifest.
std::optional<int> read_version(Json const& json) {
  if (!json.is_object() || !json.contains("manifest") || !json.contains("index")) return std::nullopt;
  Json const& version = json["manifest"];
  return version.is_number_integer() ? std::optional(version.get<int>()) : std::nullopt;
}

ManifestCase case_of(Json const& json, std::string_view line) {
  ManifestCase one;
  one.index = json.at("index").get_ref<std::uint64_t const&>();
  one.repeat = json.at("repeat").get_ref<std::uint64_t const&>();
  one.seed = json.at("seed").get_ref<std::uint64_t const&>();
  one.device = json.at("device").get<std::string>();
  for (auto const& [key, value] : json.at("parameters").items()) one.parameters.emplace_back(key, value_of(value));
  one.setup = json.at("setup").get<std::string>();
  one.inputs = json.at("inputs").get<std::map<std::string, std::string>>();
  one.line_hash = hash_of_line(line);
  return one;
}

/// Returns the start of a case's line as written by manifest_line().
std::string line_start(std::size_t index) {
  return fmt::format("{{\"manifest\":{},\"index\":{},", manifest_version, index);
}

std::string place_of(std::string const& path, std::size_t index) { return fmt::format("{}:{}", path, index + 1); }

[[noreturn]] void damaged(std::string const& place) {
  throw DataError(ErrorCode::damaged, place,
                  "is damaged or truncated (every line is one JSON object); plan the study again");
}

/// @param place  file and line, for messages
ManifestCase parse_line(std::string_view line, std::size_t index, std::string const& place) {
  Json const json = Json::parse(line, nullptr, false);
  if (!json.is_object()) damaged(place);
  std::optional<int> const version = read_version(json);
  if (!version) {
    throw DataError(ErrorCode::wrong_format, place,
                    "is not a line of a gladstone manifest (it has no \"manifest\" version and \"index\"); give the "
                    "folder of a planned study");
  }
  if (version != manifest_version) {
    throw DataError(ErrorCode::unsupported, place,
                    fmt::format("is of manifest version {} (this gladstone reads version {}); plan the study "
                                "again or use the gladstone that planned it",
                                *version, manifest_version));
  }
  ManifestCase one;
  try {
    one = case_of(json, line);
  } catch (nlohmann::json::exception const&) {
    throw DataError(ErrorCode::damaged, place,
                    "is damaged (a member that every line has is missing, or of another kind); plan the study "
                    "again");
  }
  if (!has_hash(line)) {
    throw DataError(ErrorCode::unsupported, place,
                    "contains no hash of itself (it was planned by an older gladstone); plan the study again: results "
                    "that still belong to it are kept");
  }
  if (std::string_view const hash = line.substr(line.size() - 18, 16); hash != one.line_hash) {
    throw DataError(ErrorCode::changed, place,
                    fmt::format("was changed after planning (its hash is {}, not {}); plan the study again, and "
                                "change values in the study file",
                                one.line_hash, hash));
  }
  if (one.index != index) {
    throw DataError(
        ErrorCode::damaged, place,
        fmt::format("contains case {} in place of case {} (lines are missing or out of order); plan the study again",
                    one.index, index));
  }
  return one;
}

}  // namespace

std::string number_label(double number) { return fmt::format("{}", number); }

bool ParameterValue::has_own_label() const { return number && label != number_label(*number); }

std::string ManifestCase::title() const {
  std::string text;
  for (auto const& [key, value] : parameters) text += (text.empty() ? "" : ", ") + key + " = " + value.label;
  if (repeat > 0) text += fmt::format("{}repeat {}", text.empty() ? "" : ", ", repeat);
  return fmt::format("case {}{}", index, text.empty() ? "" : " (" + text + ')');
}

std::string manifest_line(ManifestCase const& one) {
  Json json;
  json["manifest"] = manifest_version;
  json["index"] = one.index;
  json["repeat"] = one.repeat;
  json["seed"] = one.seed;
  json["device"] = one.device;
  json["parameters"] = Json::object();
  for (auto const& [key, value] : one.parameters) json["parameters"][key] = value_json(value);
  json["setup"] = one.setup;
  json["inputs"] = one.inputs;
  std::string const body = json.dump();
  return fmt::format("{}{}{}\"}}", std::string_view(body).substr(0, body.size() - 1), hash_start, content_hash(body));
}

std::string hash_of_line(std::string_view line) {
  return has_hash(line) ? content_hash(std::string(line.substr(0, line.size() - hash_end_size)) + '}')
                        : content_hash(line);
}

std::optional<int> read_manifest_version(InputFile const& file) {
  // Try the format of manifest_line() first; parse the line if another version or program wrote it.
  std::string text(64, '\0');
  text.resize(file.read(0, text.data(), text.size()));
  constexpr std::string_view start = "{\"manifest\":";
  int version = 0;
  if (text.starts_with(start)) {
    char const* const number = text.data() + start.size();
    auto const [end, error] = std::from_chars(number, text.data() + text.size(), version);
    if (error == std::errc() && text.compare(static_cast<std::size_t>(end - text.data()), 9, ",\"index\":") == 0)
      return version;
  }
  constexpr std::size_t most = std::size_t{64} << 20;
  text.resize(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), most)));
  text.resize(file.read(0, text.data(), text.size()));
  return read_version(Json::parse(text.substr(0, text.find('\n')), nullptr, false));
}

Manifest::Manifest(std::string const& path) : file_(path, "the folder of a planned study") {
  std::vector<char> buffer(std::size_t{4} << 20);
  std::size_t held = 0;    // bytes in the buffer, beginning at the start of a line
  std::uint64_t read = 0;  // bytes read from the file
  while (true) {
    std::size_t const got = file_.read(read, buffer.data() + held, buffer.size() - held);
    read += got;
    held += got;
    std::uint64_t const start = read - held;
    std::size_t begin = 0;
    while (auto const* const stop = static_cast<char const*>(std::memchr(buffer.data() + begin, '\n', held - begin))) {
      std::string_view const line(buffer.data() + begin, static_cast<std::size_t>(stop - buffer.data()) - begin);
      std::size_t const index = ends_.size();
      bool const as_written = line.starts_with(line_start(index)) && line.ends_with('}');
      ends_.push_back(start + begin + line.size());
      begin += line.size() + 1;
      if (!as_written) parse_line(line, index, place_of(path, index));
    }
    held -= begin;
    std::memmove(buffer.data(), buffer.data() + begin, held);
    if (got == 0) break;
    if (held == buffer.size()) buffer.resize(2 * buffer.size());
  }
  if (held > 0) damaged(place_of(path, ends_.size()));
  if (ends_.empty()) throw DataError(ErrorCode::missing_content, path, "is empty; plan the study again");
}

std::string Manifest::line(std::size_t index) const {
  std::uint64_t const begin = index == 0 ? 0 : ends_[index - 1] + 1;
  std::string text(static_cast<std::size_t>(ends_[index] - begin), '\0');
  text.resize(file_.read(begin, text.data(), text.size()));
  return text;
}

ManifestCase Manifest::operator[](std::size_t index) const {
  return parse_line(line(index), index, place_of(file_.path(), index));
}

std::string Manifest::line_hash(std::size_t index) const { return hash_of_line(line(index)); }

Manifest read_manifest(std::string const& run) {
  std::string const path = (std::filesystem::path(run) / run_file::manifest).string();
  std::error_code error;
  if (std::filesystem::is_regular_file(run, error)) {
    throw DataError(ErrorCode::wrong_format, run,
                    fmt::format("is a file, not the folder of a planned study; create one with: gladstone sweep "
                                "plan {} -o FOLDER, and name FOLDER here",
                                run));
  }
  if (!std::filesystem::exists(path, error)) {
    throw DataError(
        ErrorCode::wrong_format, run,
        fmt::format(
            "is not a planned study (it contains no {}); create one with: gladstone sweep plan STUDY.toml -o {}",
            run_file::manifest, run));
  }
  return Manifest(path);
}

}  // namespace gladstone::inline sweep
