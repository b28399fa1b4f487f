#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "studies/case/json_text.h"
#include "studies/case/render_sequence.h"
#include "studies/case/render_setup.h"
#include "studies/case/sequence_pair.h"
#include "studies/commands/command.h"

namespace gladstone {
namespace {

constexpr char const* example_setup =
    R"(A setup to begin with. All other keys have defaults; the setup.toml of the case lists them.

  [lens]
  focal_length_mm = 105.0
  f_number = 11.0

  [geometry]
  z_a_mm = 750.0       # from the lens to the middle of the medium
  z_d_mm = 250.0       # from there to the dots

  [medium.field]
  kind = "uniform_gradient"
  gradient_kg_m4 = [20.0, 10.0, 0.0]

A table [sequence] renders a series of frames into DIR/frames, and a case of each pair into DIR/pair_NNNN:

  [sequence]           # PIV: particles that move from frame to frame
  frames = 100
  dt_us = 10.0

  [sequence]           # BOS: a reference image, and an image of each density file
  files = ["rho_*.h5"])";

/// Returns a one-line summary of a camera's rendered case.
std::string in_words(RenderedCamera const& camera) {
  std::string text = fmt::format("{}: ", camera.folder);
  if (camera.planes > 0) text += fmt::format("{} planes, ", camera.planes);
  text += fmt::format("{} {}, {}", camera.sources, camera.particles ? "particles" : "dots", camera.rays);
  if (camera.most_rays > camera.rays) text += fmt::format(" to {}", camera.most_rays);
  text += fmt::format(" rays each{}, ", camera.planes > 0 ? "" : " in each frame");
  if (camera.step_mm) text += fmt::format("step {:.4g} mm, ", *camera.step_mm);
  if (camera.magnification) text += fmt::format("magnification {:.6g}, ", *camera.magnification);
  return text + fmt::format("{:.2f} s on {}", camera.seconds, camera.device);
}

/// Returns true if the setup has a table [sequence] whose pairs are all to be rendered.
bool is_whole_sequence(std::string const& setup, std::vector<std::string> const& overrides) {
  SetupDocument document = SetupDocument::from_file(setup);
  for (std::string const& assignment : overrides) document.override_key(assignment);
  return describes_sequence(document);
}

void render_sequence(std::string const& setup, std::vector<std::string> const& overrides, std::string const& folder,
                     GlobalOptions const& options) {
  SequenceRenderer sequence(setup, overrides);
  sequence.refuse_over_inputs(folder);
  auto const renderer = options.open_device().renderer;
  RenderedSequence const rendered = sequence.render(*renderer, folder, !options.quiet);
  for (std::string const& warning : rendered.warnings) spdlog::warn("{}", warning);
  print_result(options, json_text(rendered.summary),
               fmt::format("{}: {} frames, {} pairs ({} by an earlier run), {:.2f} s", folder, rendered.frames,
                           rendered.pairs, rendered.resumed, rendered.seconds));
}

}  // namespace

CommandBody attach_render(CLI::App& app, GlobalOptions const& options) {
  app.footer(app.get_footer() + "\n\n" + example_setup);
  struct Arguments {
    std::string setup, folder;
    std::vector<std::string> overrides;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("setup", arguments->setup, "Setup file (TOML)")->required();
  app.add_option("-o,--output", arguments->folder,
                 "Case folder to create; of a setup with [sequence], the folder of its frames and pairs")
      ->required();
  app.add_option("--set", arguments->overrides, "Override a key: --set lens.f_number=16")
      ->take_all()
      ->expected(1)
      ->trigger_on_parse(false);
  return [arguments, &options] {
    if (is_whole_sequence(arguments->setup, arguments->overrides)) {
      render_sequence(arguments->setup, arguments->overrides, arguments->folder, options);
      return ok;
    }
    SetupRenderer rendering(arguments->setup, arguments->overrides);
    rendering.refuse_over_inputs(arguments->folder);
    auto const renderer = options.open_device().renderer;
    RenderedSetup const rendered = rendering.render(*renderer, arguments->folder);
    std::string text;
    for (RenderedCamera const& camera : rendered.cameras) text += in_words(camera) + '\n';
    print_result(options, json_text(rendered.summary), text);
    return ok;
  };
}

}  // namespace gladstone
