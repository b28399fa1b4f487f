#include "studies/sweep/results.h"

#include <fmt/compile.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "render/base/error.h"
#include "render/files/content_hash.h"
#include "render/files/partial.h"
#include "render/files/stop_point.h"
#include "render/files/text_file.h"
#include "studies/case/backend.h"
#include "studies/case/warning_json.h"

namespace gladstone::inline sweep {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint64_t result_version = 2;
constexpr std::size_t hash_digits = 16;
constexpr std::string_view head = "{\"hash\":\"";  // followed by the digits, `",` and the hashed text

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double number_of(Json const& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

/// Formats the errors of vectors as one text, since large JSON arrays are slow to read: integer multiples of
/// vector_unit_px, u and v alternating, separated by blanks; "-" if unknown.
std::string numbers_text(std::vector<Vec2d> const& errors_px) {
  std::string text;
  for (Vec2d const& error : errors_px) {
    for (double const one : {error.x, error.y}) {
      if (!text.empty()) text += ' ';
      if (std::isfinite(one)) {
        fmt::format_to(std::back_inserter(text), FMT_COMPILE("{}"), std::llround(one / vector_unit_px));
      } else {
        text += '-';
      }
    }
  }
  return text;
}

std::vector<Vec2d> numbers_of(std::string const& text) {
  std::vector<Vec2d> errors;
  bool first = true;
  for (char const *at = text.data(), *const end = at + text.size(); at < end; ++at) {
    long long whole = 0;
    auto const [after, error] = std::from_chars(at, end, whole);
    double const number =
        error == std::errc() ? static_cast<double>(whole) * vector_unit_px : std::numeric_limits<double>::quiet_NaN();
    if (first) {
      errors.push_back({number, number});
    } else {
      errors.back().y = number;
    }
    first = !first;
    at = std::find(at, end, ' ');
  }
  return errors;
}

Json vectors_json(std::vector<VectorErrors> const& vectors) {
  Json json = Json::object();
  for (VectorErrors const& one : vectors) json[one.name] = numbers_text(one.errors_px);
  return json;
}

std::vector<VectorErrors> vectors_of(Json const& json) {
  std::vector<VectorErrors> vectors;
  for (auto const& [name, numbers] : json.items()) {
    vectors.push_back({name, numbers_of(numbers.get_ref<std::string const&>())});
  }
  return vectors;
}

// start of a result's numbers; quotes within texts are escaped, so this occurs nowhere before
constexpr std::string_view numbers = ",\"measures\":";

/// @param json  complete result, or its head
CaseResult result_of(Json const& json, ResultPart part) {
  CaseResult result;
  result.index = json.at("index").get_ref<std::uint64_t const&>();
  result.line_hash = json.at("line").get<std::string>();
  result.status = json.at("status").get<std::string>() == "ok" ? CaseStatus::ok : CaseStatus::failed;
  result.error = json.at("error").get<std::string>();
  result.again = json.value("again", false);
  result.pairs_only = json.value("pairs_only", false);
  result.warnings = read_warnings(json);
  result.seconds_render = number_of(json.at("seconds_render"));
  result.seconds_correlate = number_of(json.at("seconds_correlate"));
  result.seconds_compare = number_of(json.at("seconds_compare"));
  result.device = json.at("device").get<std::string>();
  result.build = json.value("build", "");
  if (part == ResultPart::head) return result;
  for (auto const& [name, value] : json.at("measures").items()) result.measures.emplace_back(name, number_of(value));
  result.vectors = vectors_of(json.at("vectors"));
  return result;
}

[[noreturn]] void cannot_be_written(std::string const& path, int error) {
  throw OutputError(path, fmt::format("cannot be written ({}); finished cases are kept, run the study again when there "
                                      "are space and write permission",
                                      std::strerror(error)));
}

}  // namespace

char const* to_string(CaseStatus status) {
  switch (status) {
    case CaseStatus::ok:
      return "ok";
    case CaseStatus::failed:
      return "failed";
    case CaseStatus::missing:
      break;
  }
  return "missing";
}

CaseResult failed_case(std::size_t index, std::string line_hash, std::string device, std::string error, bool again) {
  CaseResult result;
  result.index = index;
  result.line_hash = std::move(line_hash);
  result.status = CaseStatus::failed;
  result.error = std::move(error);
  result.again = again;
  result.seconds_render = result.seconds_correlate = result.seconds_compare = std::numeric_limits<double>::quiet_NaN();
  result.device = std::move(device);
  result.build = build_text();
  return result;
}

std::string result_path(std::string const& run, std::size_t index) {
  return (std::filesystem::path(run) / run_file::cases / (std::to_string(index) + ".json")).string();
}

std::string result_text(CaseResult const& result) {
  Json json;
  json["result"] = result_version;
  json["index"] = result.index;
  json["line"] = result.line_hash;
  json["status"] = to_string(result.status);
  json["error"] = result.error;
  if (result.again) json["again"] = true;
  if (result.pairs_only) json["pairs_only"] = true;
  json["device"] = result.device;
  json["build"] = result.build;
  json["seconds_render"] = number(result.seconds_render);
  json["seconds_correlate"] = number(result.seconds_correlate);
  json["seconds_compare"] = number(result.seconds_compare);
  json["warnings"] = to_strings(result.warnings);
  json["warning_records"] = result.warnings;
  json["measures"] = Json::object();
  Json::object_t& measures = json["measures"].get_ref<Json::object_t&>();
  for (auto const& [name, value] : result.measures) measures.emplace_back(name, number(value));
  json["vectors"] = vectors_json(result.vectors);
  // Replace invalid UTF-8, which error messages may contain (file names).
  std::string const rest = json.dump(-1, ' ', false, Json::error_handler_t::replace).substr(1) + '\n';
  return std::string(head) + content_hash(rest) + "\"," + rest;
}

std::optional<CaseResult> parse_result(std::string const& text, std::string const& path, ResultPart part) {
  std::size_t const start = head.size() + hash_digits + 2;
  if (text.size() <= start || !text.starts_with(head)) return std::nullopt;
  if (text.substr(head.size(), hash_digits) != content_hash(std::string_view(text).substr(start))) return std::nullopt;
  std::size_t const head_size = part == ResultPart::head ? text.find(numbers) : std::string::npos;
  Json const json =
      Json::parse(head_size == std::string::npos ? text : text.substr(0, head_size) + '}', nullptr, false);
  try {
    if (auto const version = json.at("result").get_ref<std::uint64_t const&>(); version != result_version) {
      throw DataError(
          ErrorCode::unsupported, path,
          fmt::format("is a result of version {} (this gladstone reads version {}); use the gladstone that made "
                      "it, plan the study into another folder, or delete {}/*.json to compute every case again",
                      version, result_version, std::filesystem::path(path).parent_path().string()));
    }
    return result_of(json, part);
  } catch (nlohmann::json::exception const&) {
    return std::nullopt;
  }
}

std::optional<CaseResult> read_result(std::string const& run, std::size_t index, std::string const& line_hash,
                                      ResultPart part) {
  std::string const path = result_path(run, index);
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  if (!S_ISREG(status.st_mode)) {
    throw DataError(
        ErrorCode::unreadable_file, path,
        fmt::format("is {}, but the result of a case is stored under this name; delete it or move it elsewhere",
                    S_ISDIR(status.st_mode) ? "a folder" : "not a regular file"));
  }
  std::string text;
  try {
    text = read_text_file(path);
  } catch (DataError const& error) {
    if (error.code() == ErrorCode::memory) throw;
    return std::nullopt;  // an unreadable file is not an intact result and is overwritten by the next run
  }
  std::optional<CaseResult> const result = parse_result(text, path, part);
  if (!result || result->index != index || result->line_hash != line_hash) return std::nullopt;
  return result;
}

bool has_result(std::string const& run, std::size_t index) {
  return ::access(result_path(run, index).c_str(), F_OK) == 0;
}

void remove_result(std::string const& run, std::size_t index) {
  std::string const path = result_path(run, index);
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    throw OutputError(
        path, fmt::format("cannot be deleted ({}), but its case must be computed again; grant write permission in {}",
                          std::strerror(errno), std::filesystem::path(path).parent_path().string()));
  }
}

void remove_abandoned_results(std::string const& run) {
  remove_abandoned_outputs((std::filesystem::path(run) / run_file::cases).string());
}

void write_result(std::string const& run, CaseResult const& result) {
  // No fsync: a result damaged by a power failure is detected by its hash and recomputed.
  std::filesystem::path const path = result_path(run, result.index);
  std::string const text = result_text(result);
  int error = 0;
  try {
    Partial partial(path.parent_path().string(), sibling_stem(path.filename().string()), Partial::Kind::file);
    for (std::size_t done = 0; error == 0 && done < text.size();) {
      ssize_t const written = ::write(partial.descriptor(), text.data() + done, text.size() - done);
      if (written > 0) done += static_cast<std::size_t>(written);
      if (written < 0 && errno != EINTR) error = errno;
      if (written == 0) error = EIO;
    }
    stop_point("result-written");
    if (error == 0) error = partial.move_to(path.string());
    if (error == 0) partial.keep();
  } catch (std::system_error const& problem) {
    error = problem.code().value();
  }
  if (error != 0) cannot_be_written(path.string(), error);
}

}  // namespace gladstone::inline sweep
