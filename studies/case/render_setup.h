#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/files/output_folder.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"

namespace gladstone::inline cases {

/// One camera's entry in the report of a rendering.
struct RenderedCamera {
  std::string folder;
  std::size_t planes = 0;   ///< number of planes of a calibration
  std::size_t sources = 0;  ///< number of dots or particles; of a calibration, in all planes together
  char const* name_of_sources = "dots";
  std::uint64_t rays = 0;               ///< smallest number of rays per source
  std::uint64_t most_rays = 0;          ///< largest number of rays of a source
  std::optional<double> step_mm;        ///< integration step; empty if there was no medium
  std::optional<double> magnification;  ///< magnification; empty if it differs between planes [1]
  double exposure_e = 0;                ///< electrons per unit of light; 0 for a calibration [e]
  double seconds = 0;
  std::string device;
};

/// Parts that a pair of a sequence shares with its other pairs.
struct SharedParts {
  struct OfCamera {
    std::optional<double> exposure_e;          ///< exposure of the first pair [e]; empty: chosen by the setup
    Image<std::uint16_t> reference;            ///< grey levels of frame A in other pairs; empty: rendered
    std::shared_ptr<ParticleCache> particles;  ///< particles of PIV; null: none
  };
  /// shared parts of each camera by its name, which is empty for the only camera
  std::map<std::string, OfCamera> cameras;
  BuiltMedium const* medium = nullptr;  ///< medium of another pair, if it is the same; null: built
};

/// Result of rendering a setup.
struct RenderedSetup {
  BuiltMedium medium;  ///< medium of the case; with several cameras that of the last one
  std::shared_ptr<nlohmann::ordered_json const> summary;  ///< contents of summary.json
  std::vector<RenderedCamera> cameras;
};

/// Reads, checks and renders a setup of any experiment with any number of cameras; implements `gladstone render`.
class SetupRenderer {
 public:
  /// @param path  path of the setup file, from which the document was read
  /// @throws SetupError if the setup is invalid
  SetupRenderer(SetupDocument document, std::string path);

  /// @throws OutputError if rendering into the folder would overwrite one of the setup's input files
  void refuse_over_inputs(std::string const& folder) const;

  /// Renders into a CASE folder atomically: all files are written, or none. The case of a single camera is written into
  /// the folder itself; those of several cameras into subfolders of their names, next to the common setup and a
  /// summary.json that contains every camera's summary.
  /// @param shared  exposure, images, particles and medium that earlier pairs of the same sequence determined
  RenderedSetup render(Renderer& renderer, std::string const& folder, SharedParts const& shared = {});

  std::vector<CameraCase> const& cameras() const { return cameras_; }
  /// Setup of the first camera.
  Setup const& first_setup() const { return cameras_.front().loaded.setup; }
  /// Returns the names of the cameras, which are their folders; empty for the only camera.
  std::vector<std::string> camera_names() const;
  /// Returns the setup as written, with absolute file names.
  std::string written() const;
  /// Returns the absolute names of all files that the setup names, except those of [correlate].
  std::vector<std::string> rendered_inputs() const;

 private:
  /// Renders one camera's case into its part of the output folder.
  /// @return the contents of its summary.json
  nlohmann::ordered_json render_one(CameraCase& camera, Renderer& renderer, ReusableParts const& known,
                                    BuiltMedium& medium, OutputFolder const& output, RenderedCamera& entry,
                                    SharedParts::OfCamera const& shared) const;

  std::string path_;
  SetupDocument document_;
  std::vector<CameraCase> cameras_;
};

}  // namespace gladstone::inline cases
