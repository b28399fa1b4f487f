#include "analysis/vectors/sequence_statistics.h"

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/files/hdf5_axes.h"

namespace gladstone::inline vectors {
namespace {

constexpr std::size_t most_lag_bytes = std::size_t{512} << 20;  // maximum memory of the autocorrelation [bytes]
constexpr std::size_t blocks_per_chunk = 4;
constexpr std::size_t fields_per_update = 8;  // number of fields whose products are added at once

bool is_measured(DisplacementField const& field, std::size_t i) {
  VectorStatus const status = field.status.empty() ? VectorStatus::valid : field.status[i];
  bool const other_peak =
      status == VectorStatus::replaced && !field.reason.empty() && field.reason[i] == VectorReason::other_peak;
  return (status == VectorStatus::valid || other_peak) && is_finite(field.displacement_px[i]);
}

/// Returns the fourth central moment from the raw moments r1 to r4.
double fourth_moment(double r1, double r2, double r3, double r4) {
  return r4 - 4 * r1 * r3 + 6 * r1 * r1 * r2 - 3 * r1 * r1 * r1 * r1;
}

double standard_error(double variance, double samples) {
  return samples > 0 ? std::sqrt(std::max(0.0, variance) / samples) : not_a_number;
}

/// Writes a quantity of all points; on a grid, also writes it as a matrix of rows and columns.
template <class Value>
void write_vector_dataset(Hdf5Writer& file, Hdf5Axes& axes, std::string const& name, std::span<Value const> values,
                          SequenceMoments const& moments, std::string const& units, std::string const& description) {
  file.write(name, values, {values.size()}, units, description, "vector");
  axes.name(name, {"/vector"});
  if (moments.columns == 0 || name == "/x_px" || name == "/y_px") return;
  file.write("/grid" + name, values,
             {static_cast<std::size_t>(moments.rows), static_cast<std::size_t>(moments.columns)}, units, description,
             "row, column");
  axes.name("/grid" + name, {"/grid/y_px", "/grid/x_px"});
}

/// Writes the positions of the columns and rows of a grid.
void write_grid_positions(Hdf5Writer& file, SequenceMoments const& moments) {
  std::vector<double> x, y;
  for (int i = 0; i < moments.columns; ++i) x.push_back(moments.position_px[static_cast<std::size_t>(i)].x);
  for (int j = 0; j < moments.rows; ++j)
    y.push_back(moments.position_px[static_cast<std::size_t>(j) * static_cast<std::size_t>(moments.columns)].y);
  file.write("/grid/x_px", std::span<double const>(x), {x.size()}, "px", "columns of the window centres", "column");
  file.write("/grid/y_px", std::span<double const>(y), {y.size()}, "px", "rows of the window centres, downwards",
             "row");
}

}  // namespace

SequenceStatistics::SequenceStatistics(std::size_t lags) : lags_(std::max<std::size_t>(1, lags)) {}

void SequenceStatistics::start(DisplacementField const& field) {
  size_ = field.size();
  blocks_ = (size_ + block_points - 1) / block_points;
  position_px_ = field.position_px;
  columns_ = field.columns;
  rows_ = field.rows;
  std::size_t const lag_bytes = std::max<std::size_t>(1, blocks_ * (sizeof(Products) + sizeof(Deviations)));
  std::size_t const latest_bytes = std::min(most_lag_bytes, blocks_ * fields_per_update * sizeof(Deviations));
  lags_ = std::clamp<std::size_t>((most_lag_bytes - latest_bytes) / lag_bytes, std::min<std::size_t>(4, lags_), lags_);
  slots_ = lags_ + fields_per_update;
  first_.assign(size_, Vec2d{not_a_number, not_a_number});
  powers_.assign(size_, {});
  products_.assign(blocks_ * lags_, {});
  history_.assign(blocks_ * slots_, {});
  with_products_ = samples_;
}

void SequenceStatistics::skip() {
  for (std::size_t block = 0; block < blocks_; ++block) deviations(block, samples_) = {};
  finish_sample();
}

void SequenceStatistics::add(DisplacementField const& field) {
  if (size_ == 0) start(field);
  GLADSTONE_EXPECTS(field.size() == size_);
  parallel_chunks(blocks_, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) add_block(field, block);
  });
  finish_sample();
}

void SequenceStatistics::add_block(DisplacementField const& field, std::size_t block) {
  Deviations& now = deviations(block, samples_);
  now = {};
  std::size_t const begin = block * block_points, end = std::min(size_, begin + block_points);
  for (std::size_t i = begin; i < end; ++i) {
    if (!is_measured(field, i)) continue;
    if (!is_finite(first_[i])) first_[i] = field.displacement_px[i];
    Vec2d const d = field.displacement_px[i] - first_[i];
    now.u[i - begin] = d.x;
    now.v[i - begin] = d.y;
    now.known[i - begin] = 1.0;
    double const a = d.x, b = d.y, aa = a * a, bb = b * b;
    Powers& sum = powers_[i];
    sum.n += 1;
    sum.a += a;
    sum.b += b;
    sum.aa += aa;
    sum.ab += a * b;
    sum.bb += bb;
    sum.aaa += aa * a;
    sum.aab += aa * b;
    sum.abb += a * bb;
    sum.bbb += bb * b;
    sum.aaaa += aa * aa;
    sum.aabb += aa * bb;
    sum.bbbb += bb * bb;
  }
}

void SequenceStatistics::finish_sample() {
  ++samples_;
  if (size_ > 0 && samples_ - with_products_ == fields_per_update) add_products();
}

void SequenceStatistics::add_products() {
  parallel_chunks(blocks_, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      for (std::size_t sample = with_products_; sample < samples_; ++sample) {
        Deviations const& now = deviations(block, sample);
        for (std::size_t lag = 1; lag <= std::min(lags_, sample); ++lag) {
          Deviations const& before = deviations(block, sample - lag);
          Products& sums = products_[block * lags_ + lag - 1];
          for (std::size_t i = 0; i < block_points; ++i) {
            double const both = now.known[i] * before.known[i];
            sums.n[i] += both;
            sums.now_u[i] += both * now.u[i];
            sums.now_v[i] += both * now.v[i];
            sums.before_u[i] += both * before.u[i];
            sums.before_v[i] += both * before.v[i];
            sums.uu[i] += now.u[i] * before.u[i];
            sums.vv[i] += now.v[i] * before.v[i];
          }
        }
      }
    }
  });
  with_products_ = samples_;
}

SequenceStatistics::CentralMoments SequenceStatistics::central_moments(std::size_t point) const {
  Powers const& sum = powers_[point];
  double const n = sum.n, a = sum.a / n, b = sum.b / n;
  CentralMoments m;
  m.mean = {a, b};
  m.m20 = std::max(0.0, sum.aa / n - a * a);
  m.m02 = std::max(0.0, sum.bb / n - b * b);
  m.m11 = sum.ab / n - a * b;
  m.m40 = fourth_moment(a, sum.aa / n, sum.aaa / n, sum.aaaa / n);
  m.m04 = fourth_moment(b, sum.bb / n, sum.bbb / n, sum.bbbb / n);
  m.m22 = (sum.aabb - 2 * b * sum.aab - 2 * a * sum.abb + b * b * sum.aa + a * a * sum.bb + 4 * a * b * sum.ab) / n -
          3 * a * a * b * b;
  return m;
}

SequenceStatistics::IndependentSamples SequenceStatistics::count_independent(std::size_t point,
                                                                             CentralMoments const& m) const {
  double const n = powers_[point].n;
  Vec2d sum;
  double uu = 0, vv = 0, uv = 0;
  bool u_positive = m.m20 > 0, v_positive = m.m02 > 0;
  std::size_t const block = point / block_points, i = point % block_points;
  for (std::size_t lag = 1; lag <= lags_ && (u_positive || v_positive); ++lag) {
    Products const& p = products_[block * lags_ + lag - 1];
    double const pairs = p.n[i];
    if (pairs == 0) {
      u_positive = v_positive = false;
      break;
    }
    // Mean of (x - mean)(y - mean) over the pairs of vectors that are both known.
    auto const covariance = [pairs](double product, double now, double before, double mean) {
      return (product - mean * (now + before)) / pairs + mean * mean;
    };
    double const weight = std::max(0.0, 1 - static_cast<double>(lag) / n);
    double const rho_u = u_positive ? covariance(p.uu[i], p.now_u[i], p.before_u[i], m.mean.x) / m.m20 : 0;
    double const rho_v = v_positive ? covariance(p.vv[i], p.now_v[i], p.before_v[i], m.mean.y) / m.m02 : 0;
    u_positive = rho_u > 0;
    v_positive = rho_v > 0;
    sum += weight * Vec2d{std::max(0.0, rho_u), std::max(0.0, rho_v)};
    if (u_positive) uu += weight * rho_u * rho_u;
    if (v_positive) vv += weight * rho_v * rho_v;
    if (u_positive && v_positive) uv += weight * rho_u * rho_v;
  }
  auto const number = [n](double correlated) { return std::max(1.0, n / (1 + 2 * correlated)); };
  return {{number(sum.x), number(sum.y)}, number(uu), number(vv), number(uv), u_positive || v_positive};
}

SequenceMoments SequenceStatistics::moments() {
  add_products();
  SequenceMoments result;
  result.position_px = position_px_;
  result.columns = columns_;
  result.rows = rows_;
  result.samples = samples_;
  result.lags = lags_;
  Vec2d const unknown{not_a_number, not_a_number};
  result.count.assign(size_, 0);
  for (auto* values :
       {&result.mean_px, &result.mean_error_px, &result.rms_px, &result.rms_error_px, &result.independent})
    values->assign(size_, unknown);
  ReynoldsStress const no_stress{not_a_number, not_a_number, not_a_number};
  result.stress_px2.assign(size_, no_stress);
  result.stress_error.assign(size_, no_stress);

  for (std::size_t i = 0; i < size_; ++i) {
    double const n = powers_[i].n;
    result.count[i] = static_cast<std::int64_t>(n);
    if (n < 1) continue;
    CentralMoments const m = central_moments(i);
    result.mean_px[i] = first_[i] + m.mean;
    if (n < 2) continue;
    IndependentSamples const independents = count_independent(i, m);
    result.unresolved += independents.unresolved;
    result.independent[i] = independents.mean;
    result.mean_error_px[i] = {standard_error(m.m20, independents.mean.x - 1),
                               standard_error(m.m02, independents.mean.y - 1)};
    double const unbiased = n / (n - 1);
    ReynoldsStress const stress{unbiased * m.m20, unbiased * m.m02, unbiased * m.m11};
    ReynoldsStress const errors{standard_error(m.m40 - m.m20 * m.m20, independents.uu),
                                standard_error(m.m04 - m.m02 * m.m02, independents.vv),
                                standard_error(m.m22 - m.m11 * m.m11, independents.uv)};
    result.stress_px2[i] = stress;
    result.stress_error[i] = errors;
    result.rms_px[i] = {std::sqrt(stress.uu), std::sqrt(stress.vv)};
    auto const rms_error = [](double stress_error, double rms) { return rms > 0 ? stress_error / (2 * rms) : 0.0; };
    result.rms_error_px[i] = {rms_error(errors.uu, result.rms_px[i].x), rms_error(errors.vv, result.rms_px[i].y)};
  }
  return result;
}

void write_sequence_statistics(std::string const& path, SequenceMoments const& moments, FileOrigin const& origin) {
  Hdf5Writer file(path, origin);
  std::size_t const size = moments.position_px.size();
  Hdf5Axes axes(file);
  axes.write_numbers("/vector", size, "number of the vector, from 0");
  if (moments.columns > 0) write_grid_positions(file, moments);
  auto const write = [&](std::string const& name, std::string const& units, std::string const& description,
                         auto const& value_of) {
    std::vector<double> values(size);
    for (std::size_t i = 0; i < size; ++i) values[i] = value_of(i);
    write_vector_dataset(file, axes, name, std::span<double const>(values), moments, units, description);
  };
  auto const write_both = [&](std::string const& quantity, std::string const& description,
                              std::vector<Vec2d> const& values, std::string const& ending = "_px") {
    char const* const units = ending.empty() ? "1" : "px";
    write("/u_" + quantity + ending, units, description + " of u", [&](std::size_t i) { return values[i].x; });
    write("/v_" + quantity + ending, units, description + " of v", [&](std::size_t i) { return values[i].y; });
  };
  auto const write_stress = [&](std::string const& ending, std::string const& description,
                                std::vector<ReynoldsStress> const& values) {
    write("/uu" + ending, "px^2", description + "variance of u", [&](std::size_t i) { return values[i].uu; });
    write("/vv" + ending, "px^2", description + "variance of v", [&](std::size_t i) { return values[i].vv; });
    write("/uv" + ending, "px^2", description + "covariance of u and v", [&](std::size_t i) { return values[i].uv; });
  };
  write("/x_px", "px", "column of the window centre, pixel centres at integers from 0",
        [&](std::size_t i) { return moments.position_px[i].x; });
  write("/y_px", "px", "row of the window centre, downwards", [&](std::size_t i) { return moments.position_px[i].y; });
  write_vector_dataset(file, axes, "/count", std::span<std::int64_t const>(moments.count), moments, "1",
                       "number of vectors that the statistics include: measured ones, not interpolated ones");
  write_both("mean", "mean", moments.mean_px);
  write_both("mean_error", "standard error of the mean", moments.mean_error_px);
  write_both("rms", "standard deviation", moments.rms_px);
  write_both("rms_error", "standard error of the standard deviation", moments.rms_error_px);
  write_stress("_px2", "", moments.stress_px2);
  write_stress("_error_px2", "standard error of the ", moments.stress_error);
  write_both("independent", "effective number of independent samples", moments.independent, "");
  axes.attach();
  file.attribute("/", "samples", static_cast<std::int64_t>(moments.samples));
  file.attribute("/", "lags", static_cast<std::int64_t>(moments.lags));
  if (moments.columns > 0) {
    file.attribute("/", "grid_columns", std::int64_t{moments.columns});
    file.attribute("/", "grid_rows", std::int64_t{moments.rows});
  }
  file.close();
}

}  // namespace gladstone::inline vectors
