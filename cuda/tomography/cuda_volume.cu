#include <algorithm>
#include <vector>

#include "cuda/device/cuda_error.h"
#include "cuda/device/device_array.h"
#include "cuda/tomography/cuda_volume.h"
#include "cuda/tomography/sart_kernels.cuh"

namespace gladstone::cuda::inline tomography {
namespace {

/// Number of blocks in sums over all nodes; constant, because the order of summation depends on it.
constexpr int sum_blocks = 512;

unsigned count_blocks(std::size_t items, int threads) {
  auto const size = static_cast<std::size_t>(threads);
  return static_cast<unsigned>((items + size - 1) / size);
}

/// Lines and line integrals of one view in device memory.
class LinesOnDevice {
 public:
  LinesOnDevice(SartView const& view, VolumeShape const& shape)
      : lines_(view.projector.lines().data(), view.projector.lines().size(), "lines of sight"),
        samples_(lines_.size(), "samples of the lines of sight"),
        value_(view.value.data(), view.value.size(), "line integrals"),
        row_sums_(view.projector.row_sums().data(), lines_.size(), "sums of weights") {
    sample_lines<<<blocks(), line_threads>>>(shape, lines_.data(), count(), samples_.data());
    check_launch("sample_lines");
  }

  int count() const { return static_cast<int>(lines_.size()); }
  unsigned blocks() const { return count_blocks(lines_.size(), line_threads); }
  DeviceView view() const { return {count(), lines_.data(), samples_.data(), value_.data(), row_sums_.data()}; }

 private:
  DeviceArray<SightLine> lines_;
  DeviceArray<LineSamples> samples_;
  DeviceArray<double> value_, row_sums_;
};

class CudaVolume : public SartVolume {
 public:
  explicit CudaVolume(SartProblem const& problem)
      : shape_(VolumeShape::of(problem.grid)),
        stencil_(TotalVariationStencil::of(problem.grid)),
        relaxation_(problem.relaxation),
        size_(problem.grid.size()),
        volume_(size_, "the volume"),
        before_(size_, "the volume"),
        denoised_(size_, "the volume"),
        views_(size_, "the number of views"),
        dual_(size_, "the dual variable"),
        support_(problem.support.data(), problem.support.size(), "the support"),
        constraint_{problem.lowest, problem.highest, problem.support.empty() ? nullptr : support_.data()},
        change_sums_(sum_blocks, "sums"),
        norm_sums_(sum_blocks, "sums") {
    volume_.zero();
    before_.zero();
    views_.zero();
    dual_.zero();
    std::size_t most_lines = 0;
    for (SartView const& view : problem.views) {
      lines_.emplace_back(view, shape_);
      first_block_.push_back(line_blocks_);
      line_blocks_ += lines_.back().blocks();
      most_lines = std::max(most_lines, view.value.size());
    }
    quotients_ = DeviceArray<double>(most_lines, "residuals");
    line_sums_ = DeviceArray<LineSums>(line_blocks_, "sums");
  }

  std::string device() const override { return "cuda"; }

  void correct(std::size_t index, bool count_views) override {
    LinesOnDevice const& lines = lines_[index];
    project_lines<<<lines.blocks(), line_threads>>>(LineProjection{shape_, volume_.data()}, lines.view(),
                                                    quotients_.data(), line_sums_.data() + first_block_[index]);
    check_launch("project_lines");
    dim3 const tiles(count_blocks(static_cast<std::size_t>(shape_.nodes[0]), tile_x),
                     count_blocks(static_cast<std::size_t>(shape_.nodes[1]), tile_y),
                     count_blocks(static_cast<std::size_t>(shape_.nodes[2]), tile_z));
    correct_nodes<<<tiles, node_threads>>>(shape_, lines.view(), quotients_.data(), relaxation_, count_views,
                                           volume_.data(), views_.data());
    check_launch("correct_nodes");
  }

  SweepSums sum_sweep() override {
    sum_changes<<<sum_blocks, node_threads>>>(volume_.data(), before_.data(), static_cast<long long>(size_),
                                              constraint_, change_sums_.data());
    check_launch("sum_changes");
    std::vector<LineSums> of_lines(line_blocks_);
    std::vector<ChangeSums> of_nodes(sum_blocks);
    line_sums_.download(of_lines.data(), of_lines.size());
    change_sums_.download(of_nodes.data(), of_nodes.size());
    SweepSums sums;
    for (std::size_t view = 0; view < lines_.size(); ++view) {
      LineSums of_view{0.0, 0.0};
      for (std::size_t block = 0; block < lines_[view].blocks(); ++block) {
        of_view.residual += of_lines[first_block_[view] + block].residual;
        of_view.value += of_lines[first_block_[view] + block].value;
      }
      sums.residual.push_back(of_view.residual);
      sums.value.push_back(of_view.value);
    }
    for (ChangeSums const& one : of_nodes) {
      sums.change += one.change;
      sums.largest = std::max(sums.largest, one.largest);
    }
    return sums;
  }

  SweepNorms regularize(double lambda, int tv_iterations) override {
    double const* denoised = volume_.data();
    if (lambda > 0.0) {
      denoise(lambda, tv_iterations);
      denoised = denoised_.data();
    }
    constrain_nodes<<<sum_blocks, node_threads>>>(denoised, constraint_, static_cast<long long>(size_), volume_.data(),
                                                  before_.data(), norm_sums_.data());
    check_launch("constrain_nodes");
    std::vector<NormSums> of_nodes(sum_blocks);
    norm_sums_.download(of_nodes.data(), of_nodes.size());
    SweepNorms norms;
    for (NormSums const& one : of_nodes) {
      norms.change += one.change;
      norms.volume += one.volume;
    }
    return norms;
  }

  void download(std::vector<double>& value, std::vector<std::int64_t>& views) const override {
    value.resize(size_);
    volume_.download(value.data(), size_);
    std::vector<long long> counts(size_);
    views_.download(counts.data(), size_);
    views.assign(counts.begin(), counts.end());
  }

 private:
  void denoise(double lambda, int iterations) {
    unsigned const blocks = count_blocks(size_, node_threads);
    auto const count = static_cast<long long>(size_);
    for (int iteration = 0; iteration <= iterations; ++iteration) {
      denoise_nodes<<<blocks, node_threads>>>(stencil_, volume_.data(), dual_.data(), lambda, count, denoised_.data());
      check_launch("denoise_nodes");
      if (iteration == iterations) break;
      project_dual<<<blocks, node_threads>>>(stencil_, denoised_.data(), lambda, count, dual_.data());
      check_launch("project_dual");
    }
  }

  VolumeShape shape_;
  TotalVariationStencil stencil_;
  double relaxation_;
  std::size_t size_;
  DeviceArray<double> volume_, before_, denoised_;  ///< volume now, volume after the last regularize(), work space
                                                    ///< [kg/m^3]
  DeviceArray<long long> views_;
  DeviceArray<Vec3d> dual_;
  DeviceArray<std::uint8_t> support_;
  NodeConstraint constraint_;
  std::vector<LinesOnDevice> lines_;
  std::vector<std::size_t> first_block_;  ///< first block of each view in line_sums_
  std::size_t line_blocks_ = 0;
  DeviceArray<double> quotients_;
  DeviceArray<LineSums> line_sums_;
  DeviceArray<ChangeSums> change_sums_;
  DeviceArray<NormSums> norm_sums_;
};

}  // namespace

std::unique_ptr<SartVolume> make_cuda_volume(SartProblem const& problem) {
  return std::make_unique<CudaVolume>(problem);
}

}  // namespace gladstone::cuda::inline tomography
