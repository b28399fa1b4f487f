#include "render/files/fields/readers/nrrd_fields.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>

#include "render/base/error.h"
#include "render/base/text.h"

namespace gladstone::inline files {
namespace {

/// Returns the standard spelling of a field name that has two.
std::string canonical(std::string const& key) {
  if (key == "datafile") return "data file";
  if (key == "lineskip") return "line skip";
  if (key == "byteskip") return "byte skip";
  return key;
}

}  // namespace

bool NrrdFields::read(LineReader& file) {
  constexpr std::uint64_t most_bytes = std::uint64_t{16} << 20;
  while (auto const text = file.next()) {
    if (file.offset() > most_bytes)
      throw DataError(ErrorCode::wrong_format, path_, "has a header of more than 16 MiB, which no NRRD file has");
    std::string const line = trimmed(*text);
    if (line.empty()) return true;
    if (line.front() == '#' || line.find(":=") != std::string::npos) continue;
    auto const colon = line.find(':');
    if (colon == std::string::npos) {
      throw DataError(ErrorCode::syntax, path_, "header line \"" + excerpt(line) + "\" is not an NRRD field");
    }
    std::string const key = canonical(trimmed(lower_case(line.substr(0, colon))));
    std::string const value = trimmed(line.substr(colon + 1));
    store(file, key, value);
    if (key == "data file" && is_list(value)) {
      read_list(file);
      return false;
    }
  }
  return false;
}

void NrrdFields::store(LineReader const& file, std::string const& key, std::string const& value) {
  auto const [given, first] = values_.try_emplace(key, value);
  if (first) {
    lines_[key] = file.number();
  } else if (given->second != value) {
    throw DataError(ErrorCode::invalid_value, file.place(),
                    fmt::format("repeats the NRRD field \"{}\" as \"{}\" (line {} says \"{}\"); remove one of them",
                                excerpt(key), excerpt(value), lines_[key], excerpt(given->second)));
  }
}

void NrrdFields::refuse(ErrorCode code, std::string const& key, std::string const& why) const {
  auto const found = values_.find(key);
  std::string const value = found == values_.end() ? "" : ": " + excerpt(found->second);
  throw DataError(code, path_, "NRRD field \"" + key + value + "\" " + why);
}

std::string const& NrrdFields::required(std::string const& key) const {
  if (!has(key)) refuse(ErrorCode::missing_content, key, "is missing in the header; write the file again");
  return values_.at(key);
}

template <class Number>
std::optional<Number> NrrdFields::parsed(std::string const& word) {
  Number value{};
  auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

template <class Number>
Number NrrdFields::number(std::string const& key, Number fallback, Number low) const {
  if (!has(key)) return fallback;
  auto const value = parsed<Number>(values_.at(key));
  if (!value || *value < low)
    refuse(ErrorCode::syntax, key, "must be a whole number of at least " + std::to_string(low));
  return *value;
}

template <class Number>
std::vector<Number> NrrdFields::numbers(std::string const& key, std::size_t count) const {
  std::istringstream words(required(key));
  std::vector<Number> values;
  for (std::string word; words >> word;) {
    auto const value = parsed<Number>(word);
    if (!value)
      refuse(ErrorCode::syntax, key,
             parsed<double>(word) ? "must be whole numbers, of 18 digits at most" : "must be numbers");
    values.push_back(*value);
  }
  if (values.size() != count) refuse(ErrorCode::wrong_shape, key, fmt::format("must be {} numbers", count));
  return values;
}

template int NrrdFields::number(std::string const&, int, int) const;
template long NrrdFields::number(std::string const&, long, long) const;
template long long NrrdFields::number(std::string const&, long long, long long) const;
template std::vector<long long> NrrdFields::numbers(std::string const&, std::size_t) const;
template std::vector<double> NrrdFields::numbers(std::string const&, std::size_t) const;

std::vector<std::vector<double>> NrrdFields::vectors(std::string const& key) const {
  std::vector<std::vector<double>> result;
  std::string const text = required(key);
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == ' ' || text[at] == '\t') {
      ++at;
      continue;
    }
    if (lower_case(text.substr(at, 4)) == "none") {
      result.emplace_back();
      at += 4;
      continue;
    }
    auto const close = text.find(')', at);
    if (text[at] != '(' || close == std::string::npos) refuse(ErrorCode::syntax, key, "must be vectors like (1,0,0)");
    std::istringstream parts(text.substr(at + 1, close - at - 1));
    auto& vector = result.emplace_back();
    for (std::string part; std::getline(parts, part, ',');) {
      auto const value = parsed<double>(trimmed(part));
      if (!value) refuse(ErrorCode::syntax, key, "must be vectors of numbers");
      vector.push_back(*value);
    }
    at = close + 1;
  }
  return result;
}

void NrrdFields::read_list(LineReader& file) {
  while (auto const text = file.next()) {
    std::string const name = trimmed(*text);
    if (name.empty()) return;
    require_room(listed_files_, path_, "data files");
    listed_files_.push_back(name);
  }
}

std::vector<std::string> NrrdFields::quoted_words(std::string const& key) const {
  std::vector<std::string> words;
  std::istringstream words_text(text(key));
  for (std::string before, word; std::getline(words_text, before, '"') && std::getline(words_text, word, '"');) {
    words.push_back(word == "???" ? "" : trimmed(word));
  }
  return words;
}

}  // namespace gladstone::inline files
