#include "studies/figures/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/output_file.h"

extern char** environ;

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Returns the environment without GNUTERM: gnuplot opens that terminal before it reads the script, and fails if it is
/// not compiled in.
std::vector<char*> environment_of_gnuplot() {
  std::vector<char*> kept;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!std::string_view(*variable).starts_with("GNUTERM=")) kept.push_back(*variable);
  }
  kept.push_back(nullptr);
  return kept;
}

/// Runs gnuplot on script.gp in the folder, with messages in log.txt; returns its exit code.
int run_gnuplot(std::string const& folder) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "log.txt", O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::array<std::string, 3> arguments{"gnuplot", "-d", "script.gp"};  // -d: ignore the user's start-up file
  std::array<char*, 4> argv{arguments[0].data(), arguments[1].data(), arguments[2].data(), nullptr};
  pid_t child = 0;
  int const error = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, argv.data(), environment_of_gnuplot().data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw GnuplotMissing();
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Returns why a file in the temporary directory could not be written, with a remedy.
std::string why_not(int error) {
  std::string const full = error == ENOSPC || error == EDQUOT ? "; free some space there or set TMPDIR" : "";
  return fmt::format("cannot be written ({}){}", std::strerror(error == 0 ? EIO : error), full);
}

std::string text_of(std::string const& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// File format of figures.
struct PictureFormat {
  std::string_view ending;
  std::string_view terminal;  ///< gnuplot terminal
  /// Last bytes of a complete file; gnuplot reports success even if the disk was full and the file is truncated.
  std::string_view last;
  double units_per_px;  ///< unit of the terminal's sizes, per pixel
  std::string_view unit;
};
constexpr std::array formats{PictureFormat{".png", "pngcairo", "IEND", 1, ""},
                             PictureFormat{".svg", "svg", "</svg>", 1, ""},
                             PictureFormat{".pdf", "pdfcairo", "%%EOF", 1.0 / 96, "in"}};  // 96 px per inch, as in CSS

/// Returns the format by file name extension; PNG for others.
PictureFormat const& format_of(std::string const& path) {
  for (PictureFormat const& format : formats) {
    if (path.ends_with(format.ending)) return format;
  }
  return formats.front();
}

/// Returns true if the file system of the folder is full.
bool is_full(std::string const& folder) {
  std::error_code error;
  return fs::space(folder, error).available == 0 && !error;
}

}  // namespace

bool draw_or_warn(std::function<void()> const& draw) {
  try {
    draw();
    return true;
  } catch (GnuplotMissing const& missing) {
    spdlog::warn("{}", missing.what());
    return false;
  }
}

GnuplotFigure::GnuplotFigure(int width_px, int height_px)
    : width_px_(width_px), height_px_(height_px), folder_(temporary_.path()) {
  GLADSTONE_EXPECTS(width_px > 0 && height_px > 0);
  command("set border linewidth 1 linecolor '#404040'");
  command("set tics nomirror out scale 0.5 textcolor '#202020'");
  command("set key noautotitle textcolor '#202020'");
}

void GnuplotFigure::command(std::string_view line) {
  script_ += line;
  script_ += '\n';
}

void GnuplotFigure::set_margins(double left, double right, double top, double bottom) {
  double const w = width_px(), h = height_px();
  command(fmt::format("set lmargin at screen {:.6f}; set rmargin at screen {:.6f}", left / w, right / w));
  command(fmt::format("set tmargin at screen {:.6f}; set bmargin at screen {:.6f}", 1 - top / h, 1 - bottom / h));
}

std::string GnuplotFigure::store(std::span<double const> values) {
  std::string const name = fmt::format("data{}.bin", files_++);
  errno = 0;
  std::ofstream file(folder_ + "/" + name, std::ios::binary);
  file.write(reinterpret_cast<char const*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
  if (!file.flush()) throw OutputError(folder_ + "/" + name, why_not(errno));
  return name;
}

std::string GnuplotFigure::add_map(Image<double> const& map, double x_first, double x_step, double y_first,
                                   double y_step) {
  GLADSTONE_EXPECTS(!map.empty() && x_step != 0.0 && y_step != 0.0);
  // gnuplot requires ascending coordinates; mirror the others.
  Image<double> upright(map.columns(), map.rows());
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      int const to_column = x_step > 0.0 ? column : map.columns() - 1 - column;
      int const to_row = y_step > 0.0 ? row : map.rows() - 1 - row;
      upright(to_column, to_row) = map(column, row);
    }
  }
  double const x_low = x_step > 0.0 ? x_first : x_first + x_step * (map.columns() - 1);
  double const y_low = y_step > 0.0 ? y_first : y_first + y_step * (map.rows() - 1);
  return fmt::format("{} binary array=({},{}) format='%float64' origin=({:.17g},{:.17g}) dx={:.17g} dy={:.17g}",
                     quoted(store({upright.data(), upright.size()})), map.columns(), map.rows(), x_low, y_low,
                     std::abs(x_step), std::abs(y_step));
}

std::string GnuplotFigure::add_table(std::vector<std::vector<double>> const& columns) {
  GLADSTONE_EXPECTS(!columns.empty());
  std::vector<double> rows;
  for (std::size_t row = 0; row < columns.front().size(); ++row) {
    for (auto const& column : columns) rows.push_back(column.at(row));
  }
  return fmt::format("{} binary format='%{}float64'", quoted(store(rows)), columns.size());
}

void GnuplotFigure::write(std::string const& path) const {
  OutputFile output(path);
  PictureFormat const& format = format_of(path);
  {
    errno = 0;
    std::ofstream script(folder_ + "/script.gp", std::ios::binary);
    script << fmt::format(
        "set terminal {0} size {1}{3},{2}{3} font 'DejaVu Sans,11' noenhanced background '#ffffff'\nset encoding utf8\n"
        "set output 'figure'\n",
        format.terminal, width_px_ * format.units_per_px, height_px_ * format.units_per_px, format.unit);
    script << script_ << "\nunset output\n";
    if (!script.flush()) throw OutputError(folder_ + "/script.gp", why_not(errno));
  }
  int const code = run_gnuplot(folder_);
  throw_if_interrupted();  // Ctrl-C also stops gnuplot
  std::string const picture = folder_ + "/figure";
  std::string const bytes = text_of(picture);
  if (code != 0 || bytes.find(format.last) == std::string::npos) {
    if (is_full(folder_)) throw OutputError(picture, why_not(ENOSPC));
    throw OutputError(path, fmt::format("gnuplot failed (exit code {}): {}", code, text_of(folder_ + "/log.txt")));
  }
  output.write(bytes.data(), bytes.size());
  output.commit();
}

std::string GnuplotFigure::quoted(std::string_view text) {
  std::string result = "'";
  for (char const c : text) {
    result += c == '\n' ? ' ' : c;
    if (c == '\'') result += '\'';
  }
  return result + "'";
}

std::string GnuplotFigure::quoted_tic(std::string_view text) {
  std::string format;
  for (char const c : text) format.append(c == '%' ? 2 : 1, c);
  return quoted(format);
}

std::string_view house_colour(std::size_t index) {
  constexpr std::array<std::string_view, 7> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                    "#e69f00", "#56b4e9", "#404040"};
  return colours[index % colours.size()];
}

}  // namespace gladstone
