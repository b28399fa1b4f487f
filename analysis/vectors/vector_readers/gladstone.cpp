#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"

namespace gladstone::detail {
namespace {

DisplacementField whole_field(std::vector<double> const& x, std::vector<double> const& y, std::vector<double> const& u,
                              std::vector<double> const& v, std::vector<double> const& sigma_u,
                              std::vector<double> const& sigma_v, std::vector<double> const& peak_ratio) {
  DisplacementField field = plain_vectors(x, y, u, v);
  for (std::size_t i = 0; i < x.size(); ++i) field.sigma_px.push_back({sigma_u[i], sigma_v[i]});
  field.peak_ratio = peak_ratio;
  return field;
}

bool is_code(double value, int most) { return value >= 0.0 && value <= most && value == std::floor(value); }

/// Adds the origin of each vector (raw displacement, reason, correlation), which files of older versions do not
/// contain.
/// @param column  returns a column by name
/// @param place   returns file location and name of the reason of vector i, for messages
template <class Column, class Place>
void add_origin(DisplacementField& field, Column const& column, Place const& place) {
  std::vector<double> const u = column("u_raw_px"), v = column("v_raw_px"), reason = column("reason"),
                            ambiguous = column("ambiguous");
  field.correlation = column("correlation");
  for (std::size_t i = 0; i < field.size(); ++i) {
    constexpr int most = static_cast<int>(VectorReason::outside);
    if (!is_code(reason[i], most)) {
      auto const [where, name] = place(i);
      throw DataError(ErrorCode::out_of_range, where,
                      fmt::format("{} = {} is not a whole number from 0 to {}", name, reason[i], most));
    }
    field.raw_px.push_back({u[i], v[i]});
    field.reason.push_back(static_cast<VectorReason>(static_cast<int>(reason[i])));
    field.ambiguous.push_back(ambiguous[i] != 0.0 ? Ambiguity::here : Ambiguity::none);
  }
}

}  // namespace

VectorFile read_gladstone_hdf5(std::string const& path) {
  Hdf5Reader const file(path);
  std::size_t count = 0;
  auto const read = [&](std::string const& dataset) {
    if (!file.has(dataset)) {
      std::string const type = file.attribute("filetype");
      if (!type.empty() && type != "gladstone vectors") {
        throw DataError(ErrorCode::wrong_format, path,
                        fmt::format("is a file of \"{}\", which contains no vectors of an image pair; use "
                                    "vectors.h5 of gladstone correlate",
                                    type));
      }
      throw DataError(ErrorCode::missing_content, path,
                      fmt::format("no dataset {} (the file contains {}); use vectors.h5 of gladstone correlate",
                                  dataset, fmt::join(file.dataset_names(), ", ")));
    }
    std::vector<double> values = file.read(dataset);
    if (dataset == "/x_px") count = values.size();
    if (values.size() != count) {
      throw DataError(ErrorCode::wrong_shape, path,
                      fmt::format("{}: {} values where /x_px has {}", dataset, values.size(), count));
    }
    return values;
  };
  auto const x = read("/x_px");
  DisplacementField field = whole_field(x, read("/y_px"), read("/u_px"), read("/v_px"), read("/sigma_u_px"),
                                        read("/sigma_v_px"), read("/peak_ratio"));
  std::vector<double> const status = read("/status");
  for (std::size_t i = 0; i < count; ++i) {
    if (!(status[i] == 0.0 || status[i] == 1.0 || status[i] == 2.0 || status[i] == 3.0)) {
      throw DataError(ErrorCode::out_of_range, path, fmt::format("/status[{}] = {} is not 0, 1, 2 or 3", i, status[i]));
    }
    field.status[i] = static_cast<VectorStatus>(static_cast<int>(status[i]));
  }
  if (file.has("/u_raw_px")) {
    add_origin(
        field, [&](std::string const& name) { return read('/' + name); },
        [&](std::size_t i) { return std::pair(path, fmt::format("/reason[{}]", i)); });
  }
  if (file.has("/failed_test")) {
    std::vector<double> const failed = read("/failed_test");
    constexpr int most = static_cast<int>(FailedTest::correlation);
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_code(failed[i], most))
        throw DataError(ErrorCode::out_of_range, path,
                        fmt::format("/failed_test[{}] = {} is not a whole number from 0 to {}", i, failed[i], most));
      field.failed.push_back(static_cast<FailedTest>(static_cast<int>(failed[i])));
    }
  }
  return {std::move(field), "gladstone", {}, false};
}

bool is_gladstone_csv(TextTable const& table) {
  for (std::string_view const name :
       {"x_px", "y_px", "u_px", "v_px", "sigma_u_px", "sigma_v_px", "peak_ratio", "status"}) {
    if (!table.find({name})) return false;
  }
  return true;
}

VectorFile read_gladstone_csv(TextTable const& table) {
  DisplacementField field =
      whole_field(table.column({"x_px"}), table.column({"y_px"}), table.column({"u_px"}), table.column({"v_px"}),
                  table.column({"sigma_u_px"}), table.column({"sigma_v_px"}), table.column({"peak_ratio"}));
  read_status(table, *table.find({"status"}), field);
  if (table.find({"u_raw_px"})) {
    add_origin(
        field, [&](std::string const& name) { return table.column({name}); },
        [&](std::size_t i) {
          return std::pair(fmt::format("{}:{}", table.path, table.line[i]), std::string("reason"));
        });
  }
  return {std::move(field), "gladstone", {}, false};
}

bool is_gladstone_tecplot(TextTable const& table) {
  return table.tecplot && table.find({"x_px"}) && table.find({"y_px"}) && table.find({"u_px"}) &&
         table.find({"v_px"}) && table.find({"status"});
}

VectorFile read_gladstone_tecplot(TextTable const& table) {
  VectorFile file = read_named_columns(table);
  DisplacementField& field = file.field;
  auto const known = [](double value) { return value > 0.0 ? value : not_a_number; };
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!field.counts(i)) field.displacement_px[i] = {not_a_number, not_a_number};
    if (!field.sigma_px.empty()) field.sigma_px[i] = {known(field.sigma_px[i].x), known(field.sigma_px[i].y)};
    if (!field.peak_ratio.empty()) field.peak_ratio[i] = known(field.peak_ratio[i]);
  }
  if (table.find({"u_raw_px"}) && table.find({"v_raw_px"}) && table.find({"reason"})) {
    std::vector<double> const unknown(field.size(), 0.0);
    add_origin(
        field, [&](std::string const& name) { return table.find({name}) ? table.column({name}) : unknown; },
        [&](std::size_t i) {
          return std::pair(fmt::format("{}:{}", table.path, table.line[i]), std::string("reason"));
        });
    for (double& correlation : field.correlation) correlation = correlation != 0.0 ? correlation : not_a_number;
    for (std::size_t i = 0; i < field.size(); ++i)
      if (!field.counts(i) && field.raw_px[i] == Vec2d{}) field.raw_px[i] = {not_a_number, not_a_number};
  }
  file.format = "gladstone";
  file.foreign = false;
  file.notes.clear();
  return file;
}

}  // namespace gladstone::detail
