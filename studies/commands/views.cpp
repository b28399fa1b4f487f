#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "render/base/units.h"
#include "studies/case/plenoptic_views.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"

namespace gladstone::inline commands {

CommandBody attach_views(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string folder, output;
    int across = 5;
    std::optional<double> refocus_mm;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("case", arguments->folder, "Case folder of a plenoptic camera")->required();
  app.add_option("-o,--output", arguments->output,
                 "Folder for FRAME/view_ROW_COLUMN.tif and views.json, default CASE/views");
  app.add_option("--views", arguments->across, "Number of views across the diameter of the stop")
      ->capture_default_str()
      ->check(whole_number(1, 99));
  app.add_option("--refocus", arguments->refocus_mm,
                 "Also write FRAME_refocused.tif, in focus on the plane of this Z [mm]");
  return [arguments, &options] {
    std::string const& folder = arguments->folder;
    std::string const place =
        arguments->output.empty() ? (std::filesystem::path(folder) / "views").string() : arguments->output;
    std::optional<double> z;
    if (arguments->refocus_mm) z = *arguments->refocus_mm * unit::millimetre;
    ViewsWritten const written = write_views(folder, place, arguments->across, z);
    std::string text = fmt::format(
        "{}: {} views of {} x {} px of each frame; the image of the stop behind a lenslet is {:.3g} px wide", place,
        written.views, written.columns, written.rows, written.camera.picture_px());
    if (z) text += fmt::format("; focused on Z = {:.6g} mm", *arguments->refocus_mm);
    print_result(options, written.json, text);
    return ok;
  };
}

}  // namespace gladstone::inline commands
