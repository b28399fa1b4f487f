#pragma once

#include <cstdint>
#include <vector>

#include "render/scene/renderer.h"
#include "studies/case/case.h"

namespace gladstone::inline cases {

/// A part of a case's images, rendered alone.
struct CasePreview {
  int first_column = 0, first_row = 0;       ///< upper left pixel of the part
  int columns = 0, rows = 0;                 ///< size of the part [px]
  bool at_gradient = false;                  ///< true: the part is centred at the strongest density gradient; false: in
                                             ///< the image
  std::vector<Image<std::uint16_t>> frames;  ///< grey levels: both frames, or that of a calibration plane
  std::size_t sources = 0;                   ///< number of dots or particles that were rendered
  std::uint64_t rays = 0;                    ///< rays per source
  RenderMethod method = RenderMethod::automatic;
  double plane_z = 0;  ///< position of the plane of a calibration [m]
  double seconds = 0;  ///< wall time [s]
};

inline constexpr int preview_side_px = 128;         ///< largest width and height of a preview
inline constexpr std::uint64_t preview_rays = 128;  ///< rays per source instead of "auto"

/// Renders the part of a setup's images about the strongest density gradient in view, or about the image centre for
/// PIV, calibrations (plane closest to Z = 0) and setups without a field. The pixels are those of the complete images
/// if the exposure and the number of rays are given. Only dots and particles whose image without medium is within
/// Setup::view_margin_px and the blur by defocus of the part are traced; if an optical element divides the light
/// (lenslets), all particles.
/// @throws DataError if no dot or particle is in this part, or if a file cannot be read
CasePreview render_preview(CaseSetup const& loaded, Renderer& renderer);

/// Returns the frames side by side as an 8-bit picture, enlarged to whole blocks of pixels of at least 384 px height.
/// @param bit_depth  bit depth of the grey levels
Image<std::uint8_t> preview_picture(CasePreview const& preview, int bit_depth);

}  // namespace gladstone::inline cases
