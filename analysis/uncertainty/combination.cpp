#include "analysis/uncertainty/combination.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <charconv>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"

namespace gladstone::inline uncertainty {
namespace {

/// Returns the negative log-likelihood sum ln sigma + e^2/(2 sigma^2), and optionally its derivatives.
double negative_log_likelihood(std::span<UncertaintySample const> samples, Eigen::VectorXd const& c,
                               Eigen::VectorXd* gradient, Eigen::MatrixXd* curvature) {
  double sum = 0.0;
  Eigen::VectorXd x(c.size());
  if (gradient) gradient->setZero(c.size());
  if (curvature) curvature->setZero(c.size(), c.size());
  for (UncertaintySample const& sample : samples) {
    x(0) = 1.0;
    for (Eigen::Index k = 1; k < c.size(); ++k) x(k) = sample.log_sigma[static_cast<std::size_t>(k - 1)];
    double const log_sigma = c.dot(x), square = sample.error_px * sample.error_px * std::exp(-2.0 * log_sigma);
    sum += log_sigma + 0.5 * square;
    if (gradient) *gradient += (1.0 - square) * x;
    if (curvature) *curvature += 2.0 * square * x * x.transpose();
  }
  return sum;
}

}  // namespace

double UncertaintyCombination::log_sigma(std::span<double const> log_sigma) const {
  GLADSTONE_EXPECTS(log_sigma.size() == terms.size());
  double sum = 0.0, known = 0.0, all = 0.0;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    all += terms[k].weight;
    if (terms[k].weight == 0.0 || !std::isfinite(log_sigma[k])) continue;
    sum += terms[k].weight * log_sigma[k];
    known += terms[k].weight;
  }
  if (!(known > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return constant + sum * (all / known);
}

UncertaintyCombination parse_combination(std::string_view text) {
  UncertaintyCombination combination;
  for (std::size_t at = text.find('\n') + 1; at < text.size();) {
    std::size_t const end = std::min(text.find('\n', at), text.size());
    std::string_view const line = text.substr(at, end - at);
    std::size_t const comma = line.find(',');
    GLADSTONE_EXPECTS(comma != std::string_view::npos);
    double value = 0.0;
    auto const [rest, error] = std::from_chars(line.data() + comma + 1, line.data() + line.size(), value);
    GLADSTONE_EXPECTS(error == std::errc() && rest == line.data() + line.size());
    if (line.substr(0, comma) == "constant")
      combination.constant = value;
    else
      combination.terms.push_back({std::string(line.substr(0, comma)), value});
    at = end + 1;
  }
  return combination;
}

std::string combination_text(UncertaintyCombination const& combination) {
  std::string text = fmt::format("term,coefficient\nconstant,{:.4f}\n", combination.constant);
  for (auto const& [method, weight] : combination.terms) text += fmt::format("{},{:.4f}\n", method, weight);
  return text;
}

UncertaintyCombination fit_combination(std::span<UncertaintySample const> samples,
                                       std::vector<std::string> const& methods) {
  GLADSTONE_EXPECTS(samples.size() > methods.size());
  Eigen::Index const size = static_cast<Eigen::Index>(methods.size()) + 1;
  // Start from the mean of all logarithms and the constant that is optimal for this mean.
  Eigen::VectorXd c = Eigen::VectorXd::Constant(size, 1.0 / static_cast<double>(methods.size())), gradient;
  c(0) = 0.0;
  double squares = 0.0;
  for (UncertaintySample const& sample : samples) {
    double log_sigma = 0.0;
    for (double const one : sample.log_sigma) log_sigma += one / static_cast<double>(methods.size());
    squares += sample.error_px * sample.error_px * std::exp(-2.0 * log_sigma);
  }
  GLADSTONE_EXPECTS(squares > 0.0);
  c(0) = 0.5 * std::log(squares / static_cast<double>(samples.size()));
  Eigen::MatrixXd curvature;
  for (int step = 0; step < 100; ++step) {
    double const before = negative_log_likelihood(samples, c, &gradient, &curvature);
    Eigen::VectorXd const direction = -curvature.ldlt().solve(gradient);
    double length = 1.0;
    while (length > 1e-10 && !(negative_log_likelihood(samples, c + length * direction, nullptr, nullptr) < before))
      length *= 0.5;
    if (!(length > 1e-10)) break;
    c += length * direction;
    if ((length * direction).norm() < 1e-9) break;
  }
  UncertaintyCombination combination{c(0), {}};
  for (Eigen::Index k = 1; k < size; ++k) combination.terms.push_back({methods[static_cast<std::size_t>(k - 1)], c(k)});
  return combination;
}

}  // namespace gladstone::inline uncertainty
