#include "analysis/correlation/fourier_plan.h"

#include <opencv2/core.hpp>
#include <opencv2/core/hal/hal.hpp>

#include "render/base/contracts.h"

namespace gladstone {
namespace {

class OpenCvFourierPlan final : public FourierPlan {
 public:
  explicit OpenCvFourierPlan(int size)
      : size_(size),
        forward_(cv::hal::DFT2D::create(size, size, CV_64F, 2, 2, CV_HAL_DFT_IS_CONTINUOUS)),
        inverse_(cv::hal::DFT2D::create(size, size, CV_64F, 2, 2, CV_HAL_DFT_IS_CONTINUOUS | CV_HAL_DFT_INVERSE)) {}

  int size() const override { return size_; }
  void forward(std::complex<double> const* in, std::complex<double>* out) override { apply(*forward_, in, out); }
  void inverse(std::complex<double> const* in, std::complex<double>* out) override { apply(*inverse_, in, out); }

 private:
  void apply(cv::hal::DFT2D& transform, std::complex<double> const* in, std::complex<double>* out) const {
    std::size_t const step = static_cast<std::size_t>(size_) * sizeof(std::complex<double>);
    transform.apply(reinterpret_cast<uchar const*>(in), step, reinterpret_cast<uchar*>(out), step);
  }

  int size_;
  cv::Ptr<cv::hal::DFT2D> forward_;
  cv::Ptr<cv::hal::DFT2D> inverse_;
};

}  // namespace

std::unique_ptr<FourierPlan> make_fourier_plan(int size) {
  GLADSTONE_EXPECTS(size > 0);
  return std::make_unique<OpenCvFourierPlan>(size);
}

}  // namespace gladstone
