#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "render/files/image_file.h"
#include "render/files/output_file.h"
#include "render/method.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/cameras.h"
#include "studies/case/json_text.h"
#include "studies/case/preview.h"
#include "studies/case/render_sequence.h"
#include "studies/case/render_setup.h"
#include "studies/case/sequence_pair.h"
#include "studies/case/warning_log.h"
#include "studies/commands/command.h"

namespace gladstone::inline commands {
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
  text += fmt::format("{} {}, {}", camera.sources, camera.name_of_sources, camera.rays);
  if (camera.most_rays > camera.rays) text += fmt::format(" to {}", camera.most_rays);
  text += fmt::format(" rays each{}, ", camera.planes > 0 ? "" : " in each frame");
  if (camera.step_mm) text += fmt::format("step {:.4g} mm, ", *camera.step_mm);
  if (camera.magnification) text += fmt::format("magnification {:.6g}, ", *camera.magnification);
  return text + fmt::format("{:.2f} s on {}", camera.seconds, camera.device);
}

struct RenderArguments {
  std::string setup, output;
  std::vector<std::string> overrides;
  bool preview = false;
};

/// Describes a preview and the results that it omits.
std::string preview_text(CasePreview const& preview, CameraSetup const& camera, std::string const& path) {
  std::string text = fmt::format(
      "{}: {} x {} of {} x {} px, from column {} and row {} on, {}; {} light sources traced in {:.2f} s\n", path,
      preview.columns, preview.rows, camera.columns, camera.rows, preview.first_column, preview.first_row,
      preview.at_gradient ? "about the strongest density gradient" : "about the image centre", preview.sources,
      preview.seconds);
  text += preview.frames.size() == 1
              ? fmt::format("  the plane Z = {:.6g} mm only\n", preview.plane_z / unit::millimetre)
              : std::string("  left: reference image or frame A, right: measurement image or frame B\n");
  text += fmt::format(
      "  left out: the rest of the image, truth and errors, other files of the case; {} rays per source", preview.rays);
  if (!camera.exposure_e) text += "; the exposure \"auto\" is that of this part";
  return text + '\n';
}

nlohmann::ordered_json preview_json(CasePreview const& preview, std::string const& path) {
  return {{"output", path},
          {"first_px", {preview.first_column, preview.first_row}},
          {"pixels", {preview.columns, preview.rows}},
          {"at_gradient", preview.at_gradient},
          {"frames", preview.frames.size()},
          {"sources", preview.sources},
          {"rays_per_source", preview.rays},
          {"method", to_string(preview.method)},
          {"seconds", preview.seconds}};
}

/// Implements --preview: renders a part of the images of every camera into a PNG.
int render_previews(RenderArguments const& arguments, GlobalOptions const& options) {
  SetupDocument const document = read_setup_document(arguments.setup, arguments.overrides);
  std::filesystem::path const output = arguments.output.empty() ? "preview.png" : arguments.output;
  if (output.extension() != ".png") {
    throw OutputError(output.string(), "is not the name of a PNG, which --preview writes; use .png");
  }
  auto const renderer = options.open_device().renderer;
  std::string text;
  nlohmann::ordered_json cameras = nlohmann::ordered_json::object(), only;
  for (auto const& [name, loaded] : load_cameras(document)) {
    log_warnings(loaded.warnings);
    std::filesystem::path path = output;
    if (!name.empty()) path.replace_filename(output.stem().string() + '_' + name + ".png");
    OutputFile file(path.string(), "PNG");
    CasePreview const preview = render_preview(loaded, *renderer);
    std::string const png = encode_png(preview_picture(preview, loaded.setup.camera.bit_depth));
    file.write(png.data(), png.size());
    file.commit();
    only = preview_json(preview, path.string());
    text += preview_text(preview, loaded.setup.camera, path.string());
    if (!name.empty()) cameras[name] = only;
  }
  print_result(options, json_text(cameras.empty() ? only : nlohmann::ordered_json{{"cameras", cameras}}), text);
  return ok;
}

void render_sequence(SetupDocument setup, std::string const& path, std::string const& folder,
                     GlobalOptions const& options) {
  SequenceRenderer sequence(std::move(setup), path);
  sequence.refuse_over_inputs(folder);
  auto const renderer = options.open_device().renderer;
  RenderedSequence const rendered = sequence.render(*renderer, folder, !options.quiet);
  log_warnings(rendered.warnings);
  print_result(options, rendered.summary,
               fmt::format("{}: {} frames, {} pairs ({} by an earlier run), {:.2f} s", folder, rendered.frames,
                           rendered.pairs, rendered.resumed, rendered.seconds));
}

/// Names the glasses of a case that several catalogues contain, and where: "glasses: SCHOTT:F2 (also in CDGM:F2)".
std::string name_shared_glasses(nlohmann::ordered_json const& summary) {
  std::vector<std::string> named;
  for (auto const& glass : summary.value("lens_glasses", nlohmann::ordered_json::array()))
    if (!glass["also_in"].empty())
      named.push_back(fmt::format("{} (also in {})", glass["catalogue"].get<std::string>(),
                                  fmt::join(glass["also_in"].get<std::vector<std::string>>(), ", ")));
  return named.empty() ? std::string() : fmt::format("glasses: {}\n", fmt::join(named, "; "));
}

}  // namespace

CommandBody attach_render(CLI::App& app, GlobalOptions const& options) {
  app.footer(app.get_footer() + "\n\n" + example_setup);
  auto arguments = std::make_shared<RenderArguments>();
  app.add_option("setup", arguments->setup, "Setup file (TOML)")->required();
  CLI::Option* const output =
      app.add_option("-o,--output", arguments->output,
                     "Case folder to create; of a setup with [sequence], the folder of its frames and pairs; with "
                     "--preview a PNG (preview.png)")
          ->required();
  app.add_flag_callback(
      "--preview",
      [arguments, output] {
        arguments->preview = true;
        output->required(false);
      },
      "Render only 128 x 128 px about the strongest density gradient, or the image centre, into a PNG");
  app.add_option("--set", arguments->overrides, "Override a key: --set lens.f_number=16")
      ->take_all()
      ->expected(1)
      ->trigger_on_parse(false);
  return [arguments, &options]() -> int {
    if (arguments->preview) return render_previews(*arguments, options);
    SetupDocument setup = read_setup_document(arguments->setup, arguments->overrides);
    if (describes_sequence(setup)) {
      render_sequence(std::move(setup), arguments->setup, arguments->output, options);
      return ok;
    }
    SetupRenderer rendering(std::move(setup), arguments->setup);
    rendering.refuse_over_inputs(arguments->output);
    auto const renderer = options.open_device().renderer;
    RenderedSetup const rendered = rendering.render(*renderer, arguments->output);
    std::string text;
    for (RenderedCamera const& camera : rendered.cameras) text += in_words(camera) + '\n';
    if (nlohmann::ordered_json const& contents = *rendered.summary; contents.contains("cameras")) {
      for (auto const& [name, summary] : contents["cameras"].items())
        if (std::string const glasses = name_shared_glasses(summary); !glasses.empty())
          text.append(name).append(": ").append(glasses);
    } else {
      text += name_shared_glasses(contents);
    }
    print_result(options, json_text(*rendered.summary), text);
    return ok;
  };
}

}  // namespace gladstone::inline commands
