#include "analysis/correlation/fourier_transform.h"

#include <opencv2/core.hpp>

#include "analysis/preparation/opencv_call.h"
#include "render/base/contracts.h"

namespace gladstone::inline correlation {

void fourier_transform(std::vector<std::complex<double>> const& in, std::vector<std::complex<double>>& out, int size,
                       FourierDirection direction) {
  GLADSTONE_EXPECTS(in.size() == static_cast<std::size_t>(size) * size && out.size() == in.size());
  cv::Mat const from(size, size, CV_64FC2, const_cast<std::complex<double>*>(in.data()));
  cv::Mat to(size, size, CV_64FC2, out.data());
  call_opencv(ErrorCode::internal, "image", "compute a Fourier transform",
              [&] { cv::dft(from, to, direction == FourierDirection::inverse ? cv::DFT_INVERSE : 0); });
}

}  // namespace gladstone::inline correlation
