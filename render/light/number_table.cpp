#include "render/light/number_table.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "render/base/error.h"

namespace gladstone::inline light {

NumberTable::NumberTable(std::string const& path, std::string const& wanted, std::vector<std::string> const& columns)
    : lines_(path, wanted), columns_(columns.size()) {
  for (std::string const& column : columns) header_ += (header_.empty() ? "" : ",") + column;
  auto const found = lines_.next();
  if (found != header_) {
    throw DataError(ErrorCode::wrong_format, path + ":1",
                    fmt::format("the header line is \"{}\" (it must be {})", excerpt(found.value_or("")), header_));
  }
}

std::optional<std::vector<double>> NumberTable::next() {
  auto line = lines_.next();
  while (line && line->empty()) line = lines_.next();
  if (!line) return std::nullopt;
  std::vector<double> row(columns_);
  char const* at = line->data();
  char const* const end = at + line->size();
  bool good = true;
  for (std::size_t i = 0; i < columns_ && good; ++i) {
    auto const [rest, error] = std::from_chars(at, end, row[i]);
    bool const last = i + 1 == columns_;
    good = error == std::errc() && std::isfinite(row[i]) && (last ? rest == end : rest != end && *rest == ',');
    at = last ? rest : rest + 1;
  }
  if (!good) {
    throw DataError(ErrorCode::syntax, lines_.place(),
                    fmt::format("\"{}\" is not {} finite numbers {}", excerpt(*line), columns_, header_));
  }
  return row;
}

}  // namespace gladstone::inline light
