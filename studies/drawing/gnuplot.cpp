#include "studies/drawing/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
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
#include "studies/drawing/draw_figure.h"

extern char** environ;

namespace gladstone::inline drawing {
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
PictureFormat const& find_format(std::string const& path) {
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

void GnuplotScript::command(std::string_view line) {
  script_ += line;
  script_ += '\n';
}

void GnuplotScript::add_file(std::string const& name, std::string_view bytes) const {
  std::string const path = folder_ + '/' + name;
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw OutputError(path, why_not(errno));
}

std::string GnuplotScript::store(std::span<double const> values) {
  std::string const name = fmt::format("data{}.bin", files_++);
  add_file(name, {reinterpret_cast<char const*>(values.data()), values.size_bytes()});
  return name;
}

std::string GnuplotScript::add_map(Image<double> const& map, double x_first, double x_step, double y_first,
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

std::string GnuplotScript::add_table(std::vector<std::vector<double>> const& columns) {
  GLADSTONE_EXPECTS(!columns.empty());
  std::vector<double> rows;
  for (std::size_t row = 0; row < columns.front().size(); ++row) {
    for (auto const& column : columns) rows.push_back(column.at(row));
  }
  return fmt::format("{} binary format='%{}float64'", quoted(store(rows)), columns.size());
}

void GnuplotScript::write(std::string const& path, int width_px, int height_px, std::string_view base_font) const {
  OutputFile output(path);
  PictureFormat const& format = find_format(path);
  add_file("script.gp", fmt::format("set encoding utf8\n"
                                    "set terminal {0} size {1}{3},{2}{3} font {4} noenhanced background '#ffffff'\n"
                                    "set output 'figure'\n{5}\nunset output\n",
                                    format.terminal, width_px * format.units_per_px, height_px * format.units_per_px,
                                    format.unit, base_font, script_));
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

std::string GnuplotScript::quoted(std::string_view text) {
  std::string result = "'";
  for (char const c : text) {
    if (c == '\n') {
      result += "'.\"\\n\".'";  // single quotes have no escapes, double quotes run commands
      continue;
    }
    result += c;
    if (c == '\'') result += '\'';
  }
  return result + "'";
}

std::string GnuplotScript::quoted_tick(std::string_view text) {
  std::string format;
  for (char const c : text) format.append(c == '%' ? 2 : 1, c);
  return quoted(format);
}

}  // namespace gladstone::inline drawing
