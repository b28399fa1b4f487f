#include <sys/stat.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// The small setup with another field or target.
std::string with_field(std::string const& file) {
  return with(small_setup, "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
              "kind = \"file\"\nfile = \"" + file + "\"");
}
std::string with_target(std::string const& kind, std::string const& file) {
  return with(small_setup, "dots_per_32px_window = 10.0", "kind = \"" + kind + "\"\nfile = \"" + file + "\"");
}

class Inputs : public ProgramFixture {
 protected:
  void make_pipe(std::string const& name) const { ASSERT_EQ(::mkfifo(in(name).c_str(), 0600), 0) << name; }

  /// Expects the program to end by itself with the exit code of invalid input, and without a message of a library;
  /// files are not compared, since a pipe cannot be read.
  Outcome expect_told(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    Outcome const outcome = Program(arguments, folder_).finish(hang_limit);
    EXPECT_EQ(outcome.exit_code, 2) << arguments[0] << outcome.err.substr(0, 400) << outcome.signal;
    // messages of libraries
    for (char const* library : {"std::", "what()", "json.exception", "filesystem error", "basic_", "OpenImageIO",
                                "TIFFOpen", "HDF5-DIAG", "Run with --help"}) {
      EXPECT_EQ(outcome.err.find(library), std::string::npos) << arguments[0] << ": " << outcome.err.substr(0, 400);
    }
    return outcome;
  }
  void expect_told(std::vector<std::string> const& arguments, std::string const& error,
                   std::vector<std::string> const& values = {}) const {
    expect_error_in(expect_told(arguments), error, values);
  }

  /// Images of dots displaced by 2 px to the right, as floating-point numbers.
  static Image<float> frame(double shift) {
    Image<float> image(96, 96);
    for (int dot = 0; dot < 120; ++dot) {
      double const x = std::fmod(37.31 * dot, 96.0) + shift, y = std::fmod(59.77 * dot, 96.0);
      for (int row = 0; row < 96; ++row) {
        for (int column = 0; column < 96; ++column) {
          double const r2 = (column - x) * (column - x) + (row - y) * (row - y);
          image(column, row) += static_cast<float>(1000 * std::exp(-r2));
        }
      }
    }
    return image;
  }
  /// One TIFF with these pages.
  /// @param orientation  corner of the image that the first stored pixel is in; 1: top left
  void write_pages(std::string const& name, std::vector<Image<float>> const& pages, int orientation = 1) const {
    TIFF* const file = ::TIFFOpen(in(name).c_str(), "w");
    ASSERT_NE(file, nullptr);
    for (Image<float> const& page : pages) {
      ::TIFFSetField(file, TIFFTAG_IMAGEWIDTH, page.columns());
      ::TIFFSetField(file, TIFFTAG_IMAGELENGTH, page.rows());
      ::TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
      ::TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 32);
      ::TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
      ::TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
      ::TIFFSetField(file, TIFFTAG_ORIENTATION, orientation);
      std::vector<float> levels(page.begin(), page.end());
      auto const bytes = static_cast<tmsize_t>(levels.size() * sizeof(float));
      ASSERT_EQ(::TIFFWriteEncodedStrip(file, 0, levels.data(), bytes), bytes);
      ASSERT_EQ(::TIFFWriteDirectory(file), 1);
    }
    ::TIFFClose(file);
  }
};

// Reading a pipe without a writer would wait forever, whatever its name.
TEST_F(Inputs, APipeInPlaceOfAnyFileIsRefusedByItsName) {
  write_tiff(in("a.tif").string(), Image<std::uint16_t>(64, 64), {});
  render("case");
  for (char const* name : {"pipe", "pipe.h5", "pipe.nrrd", "pipe.csv", "pipe.tif", "pipe.toml"}) make_pipe(name);
  expect_told({"render", "pipe.toml", "-o", "new"}, "unreadable_file at pipe.toml");
  for (char const* field : {"pipe.h5", "pipe.nrrd"}) {
    write("field.toml", with_field(field));
    expect_told({"render", "field.toml", "-o", "new"}, std::string("unreadable_file at ") + field);
  }
  write("detached.nhdr",
        "NRRD0004\ntype: float\ndimension: 2\nsizes: 4 4\nendian: little\nencoding: raw\ndata file: pipe\n");
  expect_told({"info", "field", "detached.nhdr"}, "unreadable_file at pipe");
  write("points.toml", with_target("points", "pipe.csv"));
  expect_told({"render", "points.toml", "-o", "new"}, "unreadable_file at pipe.csv");
  write("picture.toml", with_target("image", "pipe.tif"));
  expect_told({"render", "picture.toml", "-o", "new"}, "unreadable_file at pipe.tif");
  expect_told({"correlate", "a.tif", "pipe.tif", "-o", "v.csv"}, "unreadable_file at pipe.tif");
  expect_told({"correlate", "pipe.tif", "-o", "v.csv"}, "unreadable_file at pipe.tif");
  expect_told({"correlate", "case", "--config", "pipe.toml"}, "unreadable_file at pipe.toml");
  for (char const* vectors : {"pipe.csv", "pipe.h5"}) {
    expect_told({"compare", "case", "--vectors", vectors}, std::string("unreadable_file at ") + vectors);
  }
  expect_told({"trace", "setup.toml", "--rays", "pipe.csv", "-o", "out.csv"}, "unreadable_file at pipe.csv");
  expect_told({"info", "image", "pipe.tif"}, "unreadable_file at pipe.tif");
  expect_told({"info", "field", "pipe.h5"}, "unreadable_file at pipe.h5");
  expect_told({"sweep", "plan", "pipe.toml", "-o", "run"}, "unreadable_file at pipe.toml");
  write("study.toml", "base = \"pipe.toml\"\n[axes]\n\"lens.f_number\" = [8]\n");
  expect_told({"sweep", "plan", "study.toml", "-o", "run"}, "unreadable_file at study.toml:1:1", {"pipe.toml"});
  std::filesystem::create_directory(in("run"));
  make_pipe("run/manifest.jsonl");
  for (char const* command : {"status", "run", "collect"}) {
    expect_told({"sweep", command, "run"}, "unreadable_file at manifest.jsonl");
  }
}

TEST_F(Inputs, ADeviceHasNoEndAndIsRefused) {
  for (std::vector<std::string> const& command : {std::vector<std::string>{"render", "/dev/zero", "-o", "case"},
                                                  {"info", "image", "/dev/zero"},
                                                  {"trace", "setup.toml", "--rays", "/dev/zero", "-o", "out.csv"},
                                                  {"sweep", "plan", "/dev/zero", "-o", "run"}}) {
    expect_error(command, 2, "unreadable_file at zero");
  }
}

TEST_F(Inputs, RejectsNamesThatFileSystemsCannotStore) {
  std::string const name(5000, 'n');
  for (std::vector<std::string> const& command : {std::vector<std::string>{"render", name, "-o", "case"},
                                                  {"correlate", name},
                                                  {"correlate", name, name, "-o", "v.csv"},
                                                  {"compare", name},
                                                  {"info", "field", name},
                                                  {"info", "image", name},
                                                  {"trace", "setup.toml", "--rays", name, "-o", "out.csv"},
                                                  {"sweep", "plan", name, "-o", "run"},
                                                  {"sweep", "status", name}}) {
    Outcome const outcome = expect_told(command);
    EXPECT_THAT(errors_in(outcome.out), testing::Contains(testing::EndsWith(" at " + name))) << command[0];
  }
  write("field.toml", with_field(name));
  expect_told({"render", "field.toml", "-o", "case"},
              "missing_file at field.toml:" + place_of(with_field(name), "file = "));
}

TEST_F(Inputs, CommandLinesAreRefusedInOurWords) {
  expect_told({"render"}, "arguments at setup");
  expect_told({"stereo", "a", "b", "--sheet-slope", "1"}, "arguments at --sheet-slope", {"2", "1"});
  expect_told({"stereo", "a", "b", "--sheet-z", "abc"}, "arguments at --sheet-z", {"\"abc\""});
  expect_told({"stereo", "a", "b", "--spacing", "-1"}, "arguments at --spacing", {" 0", "\"-1\""});
  expect_told({"stereo", "a", "b", "--window", "nan"}, "arguments at --window", {" 0", "\"nan\""});
  expect_told({"info", "lens", "a", "--wavelength-nm", "1"}, "arguments at --wavelength-nm", {"100 to 20000", "\"1\""});
  expect_told({"design", "a", "--verify", "-1"}, "arguments at --verify", {"0 to 100", "\"-1\""});
  expect_told({"render", "setup.toml", "-o", "case", "--threads", "many"}, "arguments at --threads",
              {"0 to 4096", "\"many\""});
  expect_told({"render", "setup.toml", "-o", "case", "--threads", "-1"}, "arguments at --threads",
              {"0 to 4096", "\"-1\""});
  expect_told({"render", "setup.toml", "-o", "case", "--device", "cud"}, "arguments at --device", {"\"cuda\""});
  expect_told({"sweep", "run", "run", "--jobs", "0"}, "arguments at --jobs", {"1 to 4096", "\"0\""});
}

TEST_F(Inputs, ReportsDamagedFilesConsistently) {
  write("damaged.h5", "\x89HDF\r\n\x1a\n" + std::string(400, '\xff'));
  expect_told({"info", "field", "damaged.h5"}, "damaged at damaged.h5");
  write("damaged.tif", std::string("II*\0\x08\0\0\0\xff\xff", 10) + std::string(400, '\xff'));
  expect_told({"info", "image", "damaged.tif"}, "wrong_format at damaged.tif");
  write("damaged.png", "\x89PNG\r\n\x1a\n" + std::string(400, '\xff'));
  expect_told({"info", "image", "damaged.png"}, "wrong_format at damaged.png");
  write("damaged.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n" + std::string(2 << 20, '1'));
  expect_told({"trace", "setup.toml", "--rays", "damaged.csv", "-o", "out.csv"}, "out_of_range at damaged.csv:2");
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  write("run/manifest.jsonl", "{\"manifest\":2,\"index\":0,\"no\":1}\n");
  expect_told({"sweep", "run", "run"}, "damaged at manifest.jsonl:1");
  write("run/manifest.jsonl", std::string(200000, '[') + std::string(200000, ']') + '\n');
  expect_told({"sweep", "status", "run"}, "damaged at manifest.jsonl:1");
}

TEST_F(Inputs, AnEmptySetupIsToldAndTheHelpShowsOneToBeginWith) {
  write("empty.toml", "# nothing yet\n");
  expect_error({"render", "empty.toml", "-o", "case"}, 2, "syntax at empty.toml", {"gladstone render --help"});
  write("study.toml", "");
  expect_error({"sweep", "plan", "study.toml", "-o", "run"}, 2, "invalid_value at study.toml",
               {"gladstone sweep plan --help"});
  write("study.toml", "base = \"empty.toml\"\n[axes]\n\"lens.f_number\" = [8]\n");
  expect_error({"sweep", "plan", "study.toml", "-o", "run"}, 2, "missing_content at study.toml:1:1");

  auto const example = [&](std::vector<std::string> const& command, std::string const& heading) {
    std::istringstream help(succeed(command));
    std::string text;
    bool within = false;
    for (std::string line; std::getline(help, line);) {
      if (within && !line.empty() && !line.starts_with("  ")) break;
      if (within) text += line + '\n';
      within = within || line.starts_with(heading);
    }
    return text;
  };
  write("setup.toml", example({"render", "--help"}, "A setup to begin with"));
  render("case",
         {"--set", "camera.pixels=[64,64]", "--set", "correlate.window_px=[32,16]", "--set", "render.rays_per_dot=32"});
  write("study.toml", example({"sweep", "plan", "--help"}, "A study to begin with"));
  EXPECT_EQ(json_of({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"})["cases"], 3 * 10 * 3);
}

// Cameras for PIV write both frames into one file.
TEST_F(Inputs, AFileOfTwoPagesIsAPairAndNoPicture) {
  write_pages("a.tif", {frame(0)});
  write_pages("b.tif", {frame(2)});
  write_pages("pair.tif", {frame(0), frame(2)});
  std::vector<std::string> const settings{"--set", "correlate.window_px=[32]"};
  auto const correlate = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    arguments.insert(arguments.begin(), "correlate");
    return succeed(arguments);
  };
  correlate({"a.tif", "b.tif", "-o", "two.csv"});
  correlate({"pair.tif", "-o", "one.csv"});
  EXPECT_EQ(read("one.csv"), read("two.csv"));
  expect_error({"correlate", "pair.tif", "b.tif", "-o", "v.csv"}, 2, "wrong_shape at pair.tif", {"2 pages"});
  expect_error({"correlate", "a.tif", "-o", "v.csv"}, 2, "wrong_shape at a.tif", {"1 page"});
  expect_error({"info", "image", "pair.tif"}, 2, "wrong_shape at pair.tif", {"2 pages"});
}

// Orientation 3: the first stored pixel is the last one of the image. Frames stored like this, rotated by 180 degrees,
// are the same frames.
TEST_F(Inputs, PicturesThatAreStoredTurnedAreTurnedUprightWithAWarning) {
  auto const write_turned = [&](std::string const& name, Image<float> image) {
    std::reverse(image.begin(), image.end());
    write_pages(name, {image}, 3);
  };
  write_turned("turned_a.tif", frame(0));
  write_turned("turned_b.tif", frame(2));
  write_pages("a.tif", {frame(0)});
  write_pages("b.tif", {frame(2)});
  succeed({"correlate", "a.tif", "b.tif", "-o", "upright.csv", "--set", "correlate.window_px=[32]"});
  auto const turned =
      json_of({"correlate", "turned_a.tif", "turned_b.tif", "-o", "turned.csv", "--set", "correlate.window_px=[32]"});
  EXPECT_THAT(warnings_in(turned), testing::Contains("assumed at turned_a.tif"));
  EXPECT_EQ(read("turned.csv"), read("upright.csv"));
  EXPECT_EQ(json_of({"info", "image", "turned_a.tif"})["orientation"], 3);
}

// The known pixels of a window determine its vector: a hole of one pixel changes a vector by far less than its noise,
// 0.02 px.
TEST_F(Inputs, PixelsThatAreNoNumbersAreCountedAndLeftOut) {
  Image<float> holed = frame(0), empty(96, 96, std::nanf(""));
  for (std::size_t i = 40; i < holed.size(); i += 400) holed.data()[i] = i % 800 < 400 ? std::nanf("") : HUGE_VALF;
  write_pages("holed.tif", {holed});
  write_pages("empty.tif", {empty});
  write_pages("b.tif", {frame(2)});
  auto const holes = json_of({"correlate", "holed.tif", "b.tif", "-o", "v.csv", "--set", "correlate.window_px=[32]"});
  EXPECT_THAT(warnings_in(holes), testing::Contains("excluded at holed.tif"));
  EXPECT_THAT(holes["warnings"].dump(), ContainsWhole("23 of 9216"));
  expect_error({"correlate", "empty.tif", "b.tif", "-o", "w.csv"}, 2, "invalid_value at empty.tif", {"9216"});

  auto const told = json_of({"info", "image", "holed.tif"});
  EXPECT_EQ(told["not_finite"], 23);
  EXPECT_TRUE(told["maximum"].is_number() && told["mean"].is_number() && told["noise"].is_number());
  expect_error({"info", "image", "empty.tif"}, 2, "invalid_value at empty.tif", {"9216"});
  write("picture.toml", with_target("image", "holed.tif"));
  expect_error({"render", "picture.toml", "-o", "case"}, 2, "invalid_value at holed.tif", {"23 of 9216"});
}

/// Appends a number as little-endian bytes.
void append(std::string& bytes, std::uint32_t value, int count) {
  for (int k = 0; k < count; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
}

// 12-bit cameras write two pixels into three bytes. The same levels in 16 bits are the same image.
TEST_F(Inputs, PackedTwelveBitPicturesAreReadAsTheirLevels) {
  for (double const shift : {0.0, 2.0}) {
    Image<float> const grey = frame(shift);
    std::vector<std::uint32_t> levels;
    Image<float> whole(96, 96);
    for (std::size_t i = 0; i < grey.size(); ++i) {
      levels.push_back(static_cast<std::uint32_t>(std::lround(std::min(4095.0f, 2.0f * grey.data()[i]))));
      whole.data()[i] = static_cast<float>(levels.back());
    }
    std::string file = "II*";
    file += '\0';
    constexpr std::uint32_t size = 96 * 96 / 2 * 3;
    append(file, 8 + size, 4);
    for (std::size_t i = 0; i < levels.size(); i += 2) {
      std::uint32_t const a = levels[i], b = levels[i + 1];
      for (std::uint32_t const byte : {a >> 4, (a & 15) << 4 | b >> 8, b & 255}) append(file, byte, 1);
    }
    struct Entry {
      std::uint32_t tag, value;
    };
    // columns, rows, bits, no compression, black is zero, offset of the strip, samples, rows per strip, bytes
    Entry const entries[] = {{256, 96}, {257, 96}, {258, 12}, {259, 1},   {262, 1},
                             {273, 8},  {277, 1},  {278, 96}, {279, size}};
    append(file, std::size(entries), 2);
    for (Entry const& entry : entries) {
      append(file, entry.tag, 2);
      append(file, 4, 2);
      append(file, 1, 4);
      append(file, entry.value, 4);
    }
    append(file, 0, 4);
    std::string const letter = shift == 0.0 ? "a" : "b";
    write("packed_" + letter + ".tif", file);
    write_pages("whole_" + letter + ".tif", {whole});
  }
  for (std::string const kind : {"packed", "whole"})
    succeed({"correlate", kind + "_a.tif", kind + "_b.tif", "-o", kind + ".csv", "--set", "correlate.window_px=[32]"});
  std::istringstream packed(read("packed.csv")), whole(read("whole.csv"));
  std::string line, other;
  std::getline(packed, line);
  std::getline(whole, other);
  std::size_t vectors = 0;
  for (; std::getline(packed, line) && std::getline(whole, other); ++vectors) {
    double u[2], unused;
    char comma;
    for (int k = 0; k < 2; ++k) {
      std::istringstream row(k == 0 ? line : other);
      row >> unused >> comma >> unused >> comma >> u[k];
    }
    EXPECT_NEAR(u[0], 2.0, 0.1);
    EXPECT_NEAR(u[0], u[1], 1e-4);  // levels scaled to 16 bits: rounding in single precision
  }
  EXPECT_GT(vectors, 9u);
}

// Levels are those of the palette, not its indices: with a reversed palette the same indices are the negative image,
// which has the same displacement.
TEST_F(Inputs, PicturesWithAPaletteAreReadByIt) {
  auto const write_bitmap = [&](std::string const& name, double shift, bool reversed) {
    Image<float> const grey = frame(shift);
    std::string file = "BM";
    constexpr std::uint32_t offset = 54 + 4 * 256, size = 96 * 96;
    append(file, offset + size, 4);
    append(file, 0, 4);
    for (std::uint32_t const value : {offset, 40u, 96u, 96u, 1u | 8u << 16, 0u, size, 2835u, 2835u, 256u, 0u})
      append(file, value, 4);
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t const level = reversed ? 255 - i : i;
      append(file, level | level << 8 | level << 16, 4);
    }
    for (int row = 95; row >= 0; --row)
      for (int column = 0; column < 96; ++column)
        append(file, static_cast<std::uint32_t>(std::min(255.0f, 0.2f * grey(column, row))), 1);
    write(name, file);
  };
  for (bool const reversed : {false, true}) {
    write_bitmap("a.bmp", 0.0, reversed);
    write_bitmap("b.bmp", 2.0, reversed);
    auto const told = json_of({"info", "image", "a.bmp"});
    EXPECT_EQ(told["channels"], 1);
    EXPECT_EQ(told[reversed ? "maximum" : "minimum"], reversed ? 255 : 0);
    auto const result = json_of({"correlate", "a.bmp", "b.bmp", "-o", "v.csv", "--set", "correlate.window_px=[32]"});
    EXPECT_EQ(result["invalid"], 0);
    std::istringstream text(read("v.csv"));
    std::string line;
    std::getline(text, line);
    while (std::getline(text, line)) {
      double x, y, u;
      char comma;
      std::istringstream(line) >> x >> comma >> y >> comma >> u;
      EXPECT_NEAR(u, 2.0, 0.1) << x << ' ' << y;
    }
  }
}

// For images without signal the result is flagged, with exit code 1; one dot gives a vector at its position.
TEST_F(Inputs, PicturesWithoutDotsAreNoMeasurement) {
  for (float const level : {0.0f, 90.0f, 65535.0f}) {
    Image<float> const even(96, 96, level);
    write_pages("a.tif", {even});
    write_pages("b.tif", {even});
    Outcome const outcome = gladstone({"correlate", "a.tif", "b.tif", "-o", "v.csv", "--json"});
    EXPECT_EQ(outcome.exit_code, 1) << level << outcome.err;
    auto const json = nlohmann::json::parse(outcome.out);
    EXPECT_THAT(warnings_in(json), testing::Contains("unreliable at v.csv")) << level;
    EXPECT_EQ(json["invalid"], json["vectors"]) << level;
  }
  for (double const shift : {0.0, 2.0}) {
    Image<float> dot(96, 96);
    for (int row = 0; row < 96; ++row)
      for (int column = 0; column < 96; ++column)
        dot(column, row) = static_cast<float>(
            1000 * std::exp(-(column - 47 - shift) * (column - 47 - shift) - (row - 47.0) * (row - 47.0)));
    write_pages(shift == 0.0 ? "a.tif" : "b.tif", {dot});
  }
  auto const json = json_of({"correlate", "a.tif", "b.tif", "-o", "v.csv", "--set", "correlate.window_px=[32]"});
  EXPECT_GT(json["invalid"], 0);
  EXPECT_LT(json["invalid"], json["vectors"]);
  std::istringstream text(read("v.csv"));
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::vector<double> value;
    std::string field;
    for (std::istringstream row(line); std::getline(row, field, ',');)
      value.push_back(std::strtod(field.c_str(), nullptr));
    if (value[7] == 0.0) {  // valid
      EXPECT_NEAR(value[2], 2.0, 0.1) << line;
      EXPECT_NEAR(value[3], 0.0, 0.1) << line;
    }
  }
}

TEST_F(Inputs, SaturatedPixelsAreToldWithTheirCure) {
  auto const warning = [&](std::string const& noise, std::vector<std::string> arguments = {}) {
    write("noisy.toml", with(small_setup, "[lens]", "[camera.noise]\n" + noise + "[lens]"));
    arguments.insert(arguments.begin(), {"render", "noisy.toml", "-o", "case"});
    return json_of(arguments);
  };
  std::string const exposure = "exposure at camera.exposure";
  expect_warning_in(warning("read_noise_e = 20000.0\n"), exposure, {"camera.noise.read_noise_e", "2e+04", "0.67"});
  expect_warning_in(warning("", {"--set", "camera.exposure=90000"}), exposure, {"camera.exposure"});
  expect_warning_in(warning("dark_current_e = 1e5\n"), exposure, {"camera.noise.dark_current_e"});

  std::string const text = with(small_setup, "[lens]", "[camera.noise]\nread_noise_e = 1e6\n[lens]");
  expect_setup_error(text, "invalid_value at setup.toml:" + place_of(text, "read_noise_e"));
}

}  // namespace
}  // namespace gladstone::end_to_end
