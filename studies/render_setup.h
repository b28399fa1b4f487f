#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/cameras.h"
#include "studies/case.h"
#include "studies/uncertain_inputs.h"

namespace gladstone {

/// What a rendering tells of one camera's case in a line.
struct RenderedCamera {
  std::string folder;
  std::size_t planes = 0;   ///< of a calibration
  std::size_t sources = 0;  ///< of a calibration: of all planes
  bool particles = false;
  std::uint64_t rays = 0;               ///< a source; the least
  std::uint64_t most_rays = 0;          ///< of one
  std::optional<double> step_mm;        ///< none: there was no medium to step through
  std::optional<double> magnification;  ///< [1]; none: every plane has its own
  double seconds = 0;
  std::string device;
};

/// What is told of a setup that was rendered.
struct RenderedSetup {
  nlohmann::ordered_json summary;  ///< what summary.json holds
  std::vector<RenderedCamera> cameras;
};

/// A setup of any experiment and any number of cameras, read and checked: what `gladstone render` does.
class SetupRendering {
 public:
  /// @param path of the setup file @throws SetupError
  SetupRendering(std::string path, std::vector<std::string> const& overrides);

  /// @throws OutputError where rendering into the folder would replace what is read for it
  void refuse_over_inputs(std::string const& folder) const;

  /// Renders into a CASE folder, all of it or nothing: one camera's case into the folder itself, those of several into
  /// folders of their names, beside the setup of all and a summary.json that has each one's.
  RenderedSetup render(Renderer& renderer, std::string const& folder);

 private:
  struct OneCamera {
    std::string name;  ///< empty: the only one
    CaseSetup loaded;
    std::vector<UncertainInput> uncertain;  ///< numbers of its setup that are written with their uncertainty
  };
  /// Renders one camera's case into its place in a folder. @return what its summary.json holds
  nlohmann::ordered_json render_one(OneCamera& camera, Renderer& renderer, KnownParts const& known, BuiltMedium& medium,
                                    class OutputFolder const& output, RenderedCamera& told) const;
  /// The setup as it was written, with the absolute names of its files.
  std::string written() const;

  std::string path_;
  SetupDocument document_;
  std::vector<OneCamera> cameras_;
};

}  // namespace gladstone
