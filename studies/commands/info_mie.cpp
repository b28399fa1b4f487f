#include "studies/commands/info_mie.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/light/mie.h"
#include "studies/case/json_text.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/mie_figure.h"

namespace gladstone::inline commands {
namespace {

constexpr double least_relative_index = 0.01;  // lower limit; metals have at least 0.05
constexpr double most_relative_index = 100;

std::optional<double> as_number(std::string_view text) {
  double value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

[[noreturn]] void refuse(char const* option, std::string const& message) {
  throw DataError(ErrorCode::arguments, option, message);
}

void check_range(MieQuestion const& question) {
  if (!(question.x >= least_size_parameter && question.x <= largest_size_parameter)) {
    refuse(
        "--x",
        fmt::format("{:g} is not a valid size parameter (pi d n / lambda, from {:g} to {:g}); use a value such as 5.9",
                    question.x, least_size_parameter, largest_size_parameter));
  }
  double const n = question.m.real(), k = question.m.imag();
  if (!(n >= least_relative_index && n <= most_relative_index && k >= 0 && k <= most_relative_index)) {
    refuse("--m",
           fmt::format("n + i k = {:g} {} {:g} i is not a valid refractive index ({:g} <= n <= {:g}, 0 <= k <= {:g}, "
                       "k > 0 absorbs); use a value such as n = 1.5, k = 0.01",
                       n, std::signbit(k) ? '-' : '+', std::abs(k), least_relative_index, most_relative_index,
                       most_relative_index));
  }
}

/// Returns the angles of the plot in degrees, from forward to backward scattering: eight steps per ripple of about
/// 180/x degrees, but at least one and at most twenty per degree.
std::vector<double> drawn_angles(double x) {
  int const per_degree = std::clamp(static_cast<int>(std::ceil(8 * x / 180)), 1, 20);
  std::vector<double> angles;
  for (int i = 0; i <= 180 * per_degree; ++i) angles.push_back(static_cast<double>(i) / per_degree);
  return angles;
}

nlohmann::json pairs(std::vector<double> const& angles, std::vector<double> const& values) {
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t i = 0; i < angles.size(); ++i) rows.push_back({angles[i], values[i]});
  return rows;
}

}  // namespace

MieQuestion read_mie_question(std::string const& x_text, std::string const& m_text) {
  if (x_text.empty() || m_text.empty()) {
    throw DataError(ErrorCode::arguments, "info mie",
                    "requires --x (size parameter pi d n / lambda) and --m (refractive index of the sphere relative to "
                    "its surroundings, RE or RE,IM), such as --x 5.9 --m 1.45");
  }
  auto const x = as_number(x_text);
  if (!x) refuse("--x", fmt::format("\"{}\" is not a number; use a value such as --x 5.9", x_text));
  std::string_view const text = m_text;
  std::size_t const comma = text.find(',');
  auto const real = as_number(text.substr(0, comma));
  auto const imaginary = comma == std::string_view::npos ? 0.0 : as_number(text.substr(comma + 1));
  if (!real || !imaginary) {
    refuse("--m", fmt::format("\"{}\" is not a refractive index (RE or RE,IM for n + i k); use a value such as --m "
                              "1.5,0.01",
                              m_text));
  }
  return {*x, {*real, *imaginary}};
}

Description describe_mie(MieQuestion const& question) {
  check_range(question);
  double const x = question.x;
  std::complex<double> const m = question.m;
  MieCoefficients const sphere(x, m);
  MieEfficiencies const q = sphere.efficiencies();
  if (!std::isfinite(q.q_ext + q.q_sca + q.q_back + q.g)) {
    refuse("--m", fmt::format("the series overflows for {:g} + {:g} i at a size parameter of {:g} (no material has an "
                              "index so far from 1); use a refractive index closer to 1",
                              m.real(), m.imag(), x));
  }
  ScatteringDiagram diagram{x, m, q, drawn_angles(x), {}, {}};
  std::vector<double> s11, polarization;
  for (double const angle : diagram.angle_deg) {
    MieAmplitudes const amplitude = sphere.amplitudes(angle * unit::degree);
    diagram.s1_squared.push_back(std::norm(amplitude.s1));
    diagram.s2_squared.push_back(std::norm(amplitude.s2));
    s11.push_back(amplitude.s11());
    polarization.push_back(s11.back() > 0 ? (std::norm(amplitude.s1) - std::norm(amplitude.s2)) / (2 * s11.back())
                                          : 0.0);
  }
  char const* const source = "Bohren & Huffman 1983";
  auto const row = [source](char const* key, char const* symbol, char const* label, double value) {
    return ResultRow{.key = key, .symbol = symbol, .label = label, .value = value, .source = source};
  };
  std::vector<ResultRow> rows{row("q_ext", "Q_ext", "efficiency of extinction", q.q_ext),
                              row("q_sca", "Q_sca", "efficiency of scattering", q.q_sca),
                              row("q_abs", "Q_abs", "efficiency of absorption", m.imag() > 0 ? q.q_ext - q.q_sca : 0.0),
                              row("q_back", "Q_back", "efficiency of backscattering", q.q_back),
                              row("g", "g", "mean cosine", q.g)};
  nlohmann::ordered_json json{{"x", x}, {"m", {m.real(), m.imag()}}};
  json.update(rows_json(rows));
  json["s11"] = pairs(diagram.angle_deg, s11);
  json["polarization"] = pairs(diagram.angle_deg, polarization);
  std::string text = fmt::format("sphere of x = {:.10g}, m = {:.6g} + {:.6g} i, {} terms\n{}", x, m.real(), m.imag(),
                                 sphere.a().size(), rows_text(rows)) +
                     "  angle [deg]       |S1|^2        |S2|^2           S11  polarization\n";
  std::size_t const tenth = (diagram.angle_deg.size() - 1) / 18;
  for (std::size_t i = 0; i < diagram.angle_deg.size(); i += tenth) {
    text += fmt::format("  {:>11.4g}  {:>11.6g}   {:>11.6g}   {:>11.6g}  {:>12.5f}\n", diagram.angle_deg[i],
                        diagram.s1_squared[i], diagram.s2_squared[i], s11[i], polarization[i]);
  }
  auto const draw = [&] { draw_figure(make_mie_figure(diagram), question.figure); };
  if (!question.figure.empty() && draw_or_warn(draw)) json["figure"] = question.figure;
  return {json_text(json), text, std::move(rows)};
}

}  // namespace gladstone::inline commands
