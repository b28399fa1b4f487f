#include "analysis/tomography/sart_volume.h"

#include <algorithm>
#include <cmath>

#include "analysis/tomography/total_variation.h"

namespace gladstone::inline tomography {
namespace {

class HostVolume : public SartVolume {
 public:
  explicit HostVolume(SartProblem const& problem)
      : problem_(problem),
        constraint_{problem.lowest, problem.highest, problem.support.empty() ? nullptr : problem.support.data()},
        value_(problem.grid.size(), 0.0),
        before_(value_),
        views_(problem.grid.size(), 0),
        denoiser_(problem.grid) {
    clear_sums();
  }

  std::string device() const override { return "cpu"; }

  void correct(std::size_t index, bool count_views) override {
    SartView const& view = problem_.views[index];
    double squared_residual = 0.0, squared_value = 0.0;
    std::vector<double> residual = view.projector.project(value_);
    for (std::size_t i = 0; i < residual.size(); ++i) {
      LineResidual const line = LineResidual::of(view.value[i], residual[i], view.projector.row_sums()[i]);
      residual[i] = line.quotient;
      if (!std::isfinite(view.value[i])) continue;
      squared_residual += line.difference * line.difference;
      squared_value += view.value[i] * view.value[i];
    }
    sweep_.residual[index] = squared_residual;
    sweep_.value[index] = squared_value;
    view.projector.back_project(residual, sums_);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      if (!(sums_[i].weight > 0.0)) continue;
      value_[i] = correct_node(value_[i], sums_[i], problem_.relaxation);
      if (count_views) ++views_[i];
    }
  }

  SweepSums sum_sweep() override {
    for (std::size_t i = 0; i < value_.size(); ++i) {
      double const change = constraint_.is_free(i) ? value_[i] - before_[i] : 0.0;
      sweep_.change += change * change;
      sweep_.largest = std::max(sweep_.largest, std::abs(value_[i]));
    }
    return sweep_;
  }

  SweepNorms regularize(double lambda, int tv_iterations) override {
    denoiser_.denoise(value_, lambda, tv_iterations);
    SweepNorms norms;
    for (std::size_t i = 0; i < value_.size(); ++i) {
      value_[i] = constraint_(value_[i], i);
      double const change = value_[i] - before_[i];
      norms.change += change * change;
      norms.volume += value_[i] * value_[i];
    }
    before_ = value_;
    clear_sums();
    return norms;
  }

  void download(std::vector<double>& value, std::vector<std::int64_t>& views) const override {
    value = value_;
    views = views_;
  }

 private:
  void clear_sums() {
    sweep_ = {};
    sweep_.residual.assign(problem_.views.size(), 0.0);
    sweep_.value.assign(problem_.views.size(), 0.0);
  }

  SartProblem problem_;
  NodeConstraint constraint_;
  std::vector<double> value_, before_;  ///< current volume, and volume after the last regularize() [kg/m^3]
  std::vector<std::int64_t> views_;
  std::vector<NodeSum> sums_;
  TotalVariation denoiser_;
  SweepSums sweep_;
};

}  // namespace

std::unique_ptr<SartVolume> make_host_volume(SartProblem const& problem) {
  return std::make_unique<HostVolume>(problem);
}

}  // namespace gladstone::inline tomography
