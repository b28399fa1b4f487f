#include "render/files/image_file.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <utility>

#include "render/base/error.h"
#include "render/files/image_pages.h"
#include "render/files/source_files.h"
#include "tests/files/support/output.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string temporary(std::string const& name) { return (fs::path(testing::TempDir()) / ("image_" + name)).string(); }

/// Image that contains every 16-bit value once.
Image<std::uint16_t> all_values() {
  Image<std::uint16_t> image(256, 256);
  for (int i = 0; i < 65536; ++i) image.data()[i] = static_cast<std::uint16_t>(i);
  return image;
}

/// Writes an image in any format supported by OpenImageIO.
template <class Sample>
std::string write_picture(std::string const& name, std::vector<Sample> const& samples, int columns, int channels) {
  std::string const path = temporary(name);
  int const rows = static_cast<int>(samples.size()) / columns / channels;
  OIIO::ImageSpec const spec(columns, rows, channels, OIIO::BaseTypeFromC<Sample>::value);
  auto const output = OIIO::ImageOutput::create(path);
  EXPECT_TRUE(output && output->open(path, spec) &&
              output->write_image(OIIO::BaseTypeFromC<Sample>::value, samples.data()));
  EXPECT_TRUE(output->close());
  return path;
}

// OpenImageIO reads what the encoder writes: every grey level, a single pixel, and more bytes than one deflate block.
TEST(ImageFile, EveryValueOfAnEncodedPngComesBack) {
  for (auto const& [columns, rows] : {std::pair{256, 3}, {1, 1}, {7, 300}, {400, 400}}) {
    Image<std::uint8_t> image(columns, rows);
    for (std::size_t i = 0; i < image.size(); ++i) image.data()[i] = static_cast<std::uint8_t>(i * i / 3 + i);
    std::string const path = temporary("encoded.png");
    std::ofstream(path, std::ios::binary) << encode_png(image);
    ImageMetadata metadata;
    auto const back = read_image(path, &metadata);
    ASSERT_EQ(back.columns(), columns);
    ASSERT_EQ(back.rows(), rows);
    EXPECT_EQ(metadata.channels, 1);
    for (std::size_t i = 0; i < image.size(); ++i) ASSERT_EQ(back.data()[i], image.data()[i]) << columns << ' ' << i;
  }
}

TEST(ImageFile, EveryValueOfA16BitTiffComesBack) {
  std::string const path = temporary("all.tif");
  auto const image = all_values();
  write_tiff(path, image, {12, 10e-6, "schema = 1\n# umlaut \xc3\xa4\n"});
  ImageMetadata metadata;
  auto const back = read_image(path, &metadata);
  ASSERT_EQ(back.columns(), 256);
  ASSERT_EQ(back.rows(), 256);
  for (std::size_t i = 0; i < image.size(); ++i) ASSERT_EQ(back.data()[i], image.data()[i]);
  EXPECT_EQ(metadata.bit_depth, 12);
  EXPECT_EQ(metadata.pixel_pitch_m, 10e-6);
  EXPECT_EQ(metadata.description, "schema = 1\n# umlaut \xc3\xa4\n");
}

TEST(ImageFile, OtherProgramsFindResolutionAndSoftware) {
  std::string const path = temporary("resolution.tif");
  write_tiff(path, Image<std::uint16_t>(3, 2, 7), {16, 10e-6, "text"});
  auto const input = OIIO::ImageInput::open(path);
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::UINT16);
  EXPECT_EQ(input->spec().nchannels, 1);
  EXPECT_FLOAT_EQ(input->spec().get_float_attribute("XResolution"), 1000.0f);  // 10 um: 1000 pixels per centimetre
  EXPECT_FLOAT_EQ(input->spec().get_float_attribute("YResolution"), 1000.0f);
  EXPECT_EQ(input->spec().get_string_attribute("ResolutionUnit"), "cm");
  EXPECT_THAT(std::string(input->spec().get_string_attribute("Software")), HasSubstr("gladstone"));
  EXPECT_THAT(std::string(input->spec().get_string_attribute("ImageDescription")), HasSubstr("\ntext"));
  EXPECT_EQ(input->spec().find_attribute("DateTime"), nullptr);
}

// The hash of an image is that of its pixels, in any format.
TEST(ImageFile, EqualPixelsOfAnotherProgramHaveTheSameHash) {
  auto const image = all_values();
  std::vector<std::uint16_t> const samples(image.begin(), image.end());
  EXPECT_EQ(pixel_sha256(write_picture("hash.png", samples, 256, 1)), pixel_sha256(image));
}

TEST(ImageFile, SingleRowAndEmptyDescriptionWork) {
  std::string const path = temporary("row.tif");
  write_tiff(path, Image<std::uint16_t>(5, 1, 9), {});
  ImageMetadata metadata;
  EXPECT_EQ(read_image(path, &metadata)(4, 0), 9.0);
  EXPECT_EQ(metadata.description, "");
  EXPECT_EQ(metadata.bit_depth, 16);
  EXPECT_EQ(metadata.pixel_pitch_m, 0.0);
}

TEST(ImageFile, ValuesOfOtherFormatsAreRaw) {
  ImageMetadata metadata;
  auto const bytes = read_image(write_picture<std::uint8_t>("8.png", {0, 1, 128, 255}, 2, 1), &metadata);
  EXPECT_THAT(std::vector<double>(bytes.begin(), bytes.end()), testing::ElementsAre(0, 1, 128, 255));
  EXPECT_EQ(bytes(1, 0), 1.0);
  EXPECT_EQ(metadata.bit_depth, 8);
  auto const words = read_image(write_picture<std::uint16_t>("16.png", {0, 1, 4095, 65535}, 4, 1), &metadata);
  EXPECT_THAT(std::vector<double>(words.begin(), words.end()), testing::ElementsAre(0, 1, 4095, 65535));
  EXPECT_EQ(metadata.bit_depth, 16);
  auto const floats = read_image(write_picture<float>("float.tif", {-1.5f, 0.25f, 1e6f, 3.0f}, 2, 1));
  EXPECT_THAT(std::vector<double>(floats.begin(), floats.end()), testing::ElementsAre(-1.5, 0.25, 1e6, 3.0));
}

// A PGM file declares its largest level, 4095 for a camera of 12 bits, to which OpenImageIO scales its levels.
TEST(ImageFile, LevelsOfPgmFilesAreThoseInTheFile) {
  for (auto const& [maximum, bits] : {std::pair{1, 1}, {100, 7}, {200, 8}, {255, 8}, {1023, 10}, {4095, 12}}) {
    for (bool const text : {false, true}) {
      std::string const path = temporary("levels.pgm");
      std::ofstream file(path, std::ios::binary);
      file << (text ? "P2" : "P5") << "\n# made by a camera\n" << maximum + 1 << " 1\n" << maximum << '\n';
      for (int level = 0; level <= maximum; ++level) {
        if (text) {
          file << level << '\n';
        } else {
          if (maximum > 255) file.put(static_cast<char>(level >> 8));
          file.put(static_cast<char>(level & 255));
        }
      }
      file.close();
      ImageMetadata metadata;
      auto const image = read_image(path, &metadata);
      ASSERT_EQ(image.columns(), maximum + 1);
      EXPECT_EQ(metadata.bit_depth, bits);
      for (int level = 0; level <= maximum; ++level)
        ASSERT_EQ(image(level, 0), level) << maximum << (text ? " text" : "");
    }
  }
}

// Lossy compression changes the levels of a uniform image by its conversion to YUV of 8 bits and back, by 2 at most.
TEST(ImageFile, WebPIsRead) {
  auto const image =
      read_image(write_picture<std::uint8_t>("uniform.webp", std::vector<std::uint8_t>(3 * 256, 100), 16, 3));
  ASSERT_EQ(image.columns(), 16);
  for (double const level : image) EXPECT_NEAR(level, 100, 2);
}

/// Writes a TIFF of 12 packed bits that contains every value once.
std::string write_packed_bits() {
  std::string path = temporary("12.tif");
  OIIO::ImageSpec spec(4096, 1, 1, OIIO::TypeDesc::UINT16);
  spec["oiio:BitsPerSample"] = 12;
  std::vector<std::uint16_t> samples(4096);
  for (int i = 0; i < 4096; ++i) samples[i] = static_cast<std::uint16_t>((i * 65535 + 2047) / 4095);
  auto const output = OIIO::ImageOutput::create(path);
  EXPECT_TRUE(output && output->open(path, spec) && output->write_image(OIIO::TypeDesc::UINT16, samples.data()));
  EXPECT_TRUE(output->close());
  return path;
}

TEST(ImageFile, TwelvePackedBitsKeepTheirValues) {
  ImageMetadata metadata;
  auto const image = read_image(write_packed_bits(), &metadata);
  EXPECT_EQ(metadata.bit_depth, 12);
  for (int i = 0; i < 4096; ++i) ASSERT_EQ(image(i, 0), i);
}

TEST(ImageFile, ColourBecomesLuminanceAndAlphaIsIgnored) {
  ImageMetadata metadata;
  auto const colour =
      read_image(write_picture<std::uint8_t>("rgb.png", {100, 0, 0, 0, 100, 0, 0, 0, 100, 9, 9, 9}, 4, 3), &metadata);
  EXPECT_EQ(metadata.channels, 3);
  // Rec. ITU-R BT.709, section 3.2; the weights sum to 1
  EXPECT_NEAR(colour(0, 0), 21.26, 1e-12);
  EXPECT_NEAR(colour(1, 0), 71.52, 1e-12);
  EXPECT_NEAR(colour(2, 0), 7.22, 1e-12);
  EXPECT_NEAR(colour(3, 0), 9.0, 1e-12);
  auto const grey = read_image(write_picture<std::uint8_t>("greyalpha.png", {80, 255, 50, 128}, 2, 2));
  EXPECT_EQ(grey(0, 0), 80.0);
  // OpenImageIO's writer assumes that 50 is already multiplied by the opacity 128/255, and stores 50 / (128/255) =
  // 99.6.
  EXPECT_NEAR(grey(1, 0), 99.6, 1.0);
}

// Integers of one channel are read as they are; colours and floats are real numbers. The grey levels and the hash are
// those of read_image().
TEST(ImageFile, IntegersAreReadAsTheyAre) {
  std::string const turned = temporary("turned.tif");
  OIIO::ImageSpec spec(3, 2, 1, OIIO::TypeDesc::UINT16);
  spec["Orientation"] = 6;
  std::vector<std::uint16_t> const samples{1, 2, 3, 40000, 50000, 65535};
  auto const output = OIIO::ImageOutput::create(turned);
  ASSERT_TRUE(output && output->open(turned, spec) && output->write_image(OIIO::TypeDesc::UINT16, samples.data()));
  ASSERT_TRUE(output->close());
  std::string const written = temporary("written.tif");
  write_tiff(written, all_values(), {12, 0, ""});
  for (auto const& [path, are_integers] :
       {std::pair{turned, true},
        {written, true},
        {write_packed_bits(), true},
        {write_picture<std::uint8_t>("8.png", {0, 1, 128, 255}, 2, 1), true},
        {write_picture<std::uint8_t>("rgb.png", {100, 0, 0, 0, 100, 0}, 2, 3), false},
        {write_picture<float>("float.tif", {-1.5f, 0.25f, 1e6f, 3.0f}, 2, 1), false}}) {
    ImageMetadata metadata;
    Image<double> const expected = read_image(path, &metadata);
    StoredLevels const found = read_levels(path);
    EXPECT_EQ(std::holds_alternative<Image<std::uint16_t>>(found), are_integers) << path;
    std::visit(
        [&, &name = path](auto const& image) {
          EXPECT_EQ(image.columns(), expected.columns()) << name;
          EXPECT_TRUE(std::equal(image.begin(), image.end(), expected.begin(), expected.end())) << name;
        },
        found);
    EXPECT_EQ(pixel_sha256(path), pixel_sha256(expected, metadata.sample_bits)) << path;
  }
}

TEST(ImageFile, EqualImagesAreEqualFiles) {
  write_tiff(temporary("a.tif"), all_values(), {12, 6.5e-6, "x"});
  write_tiff(temporary("b.tif"), all_values(), {12, 6.5e-6, "x"});
  EXPECT_EQ(content(temporary("a.tif")), content(temporary("b.tif")));
}

TEST(ImageFile, UnreadablePicturesAreNamed) {
  EXPECT_THAT([] { read_image("/no/such/picture.tif"); },
              ThrowsDataError(ErrorCode::missing_file, "/no/such/picture.tif"));
  std::ofstream(temporary("text.tif")) << "not a picture";
  EXPECT_THAT([] { read_image(temporary("text.tif")); }, ThrowsDataError(ErrorCode::wrong_format, "text.tif"));
  write_tiff(temporary("cut.tif"), all_values(), {});
  std::string const whole = content(temporary("cut.tif"));
  std::ofstream(temporary("cut.tif"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_THAT([] { read_image(temporary("cut.tif")); }, ThrowsDataError(ErrorCode::wrong_format, "cut.tif"));
}

/// Writes a TIFF with several pages; the value of all pixels of a page is its number.
std::string write_pages(std::string const& name, std::vector<std::pair<int, int>> const& sizes) {
  std::string const path = temporary(name);
  auto const output = OIIO::ImageOutput::create(path);
  for (std::size_t page = 0; page < sizes.size(); ++page) {
    auto const [columns, rows] = sizes[page];
    OIIO::ImageSpec const spec(columns, rows, 1, OIIO::TypeDesc::UINT16);
    std::vector<std::uint16_t> const values(spec.image_pixels(), static_cast<std::uint16_t>(page + 1));
    auto const mode = page == 0 ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendSubimage;
    EXPECT_TRUE(output->open(path, spec, mode) && output->write_image(OIIO::TypeDesc::UINT16, values.data()));
  }
  EXPECT_TRUE(output->close());
  return path;
}

TEST(ImageFile, SeveralPagesAreRefusedWithTheirNumberAndTwoAreAPair) {
  std::string const pair = write_pages("pair.tif", {{8, 6}, {8, 6}});
  EXPECT_THAT([&] { read_image(pair); }, ThrowsDataError(ErrorCode::wrong_shape, "pair.tif", HasSubstr("2 pages")));
  auto const [reference, flow] = read_frame_pair(pair);
  EXPECT_EQ(reference.columns(), 8);
  EXPECT_EQ(reference(7, 5), 1);
  EXPECT_EQ(flow(0, 0), 2);

  std::string const film = write_pages("film.tif", {{8, 6}, {8, 6}, {8, 6}});
  EXPECT_THAT([&] { read_frame_pair(film); },
              ThrowsDataError(ErrorCode::wrong_shape, "film.tif", HasSubstr("3 pages")));
  std::string const one = write_pages("one.tif", {{8, 6}});
  EXPECT_THAT([&] { read_frame_pair(one); }, ThrowsDataError(ErrorCode::wrong_shape, "one.tif", HasSubstr("1 page,")));
}

// Cameras and image viewers append small previews to an image.
TEST(ImageFile, PreviewsAreNoPages) {
  EXPECT_EQ(read_image(write_pages("preview.tif", {{64, 48}, {16, 12}}))(0, 0), 1);
  auto const [reference, flow] = read_frame_pair(write_pages("previews.tif", {{64, 48}, {16, 12}, {64, 48}, {16, 12}}));
  EXPECT_EQ(reference(0, 0), 1);
  EXPECT_EQ(flow(0, 0), 3);
}

// Pages are read by the offsets of their directories, in any order, whatever previews lie between them.
TEST(ImagePages, AreReadInAnyOrder) {
  ImagePages const pages(write_pages("film.tif", {{64, 48}, {16, 12}, {60, 50}, {16, 12}, {64, 48}}));
  ASSERT_EQ(pages.count(), 3u);
  EXPECT_EQ(pages.read(2)(0, 0), 5);
  EXPECT_EQ(pages.read(0)(63, 47), 1);
  EXPECT_EQ(pages.read(1)(0, 0), 3);
  EXPECT_EQ(pages.size(1), (std::array<int, 2>{60, 50}));
  EXPECT_THAT([&] { pages.read(3); }, ThrowsDataError(ErrorCode::missing_content, "film.tif", HasSubstr("no page 4")));
}

/// Writes a TIFF of pages of 2 x 1 px of 8 bits, which contain the lowest byte of their index.
/// @param next  index of the page that follows a page; the number of pages: none
std::string write_small_pages(std::string const& name, std::size_t pages, bool big_endian, bool big_tiff,
                              std::function<std::size_t(std::size_t)> const& next) {
  std::string bytes = big_endian ? "MM" : "II";
  auto const put = [&](std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * (big_endian ? size - 1 - i : i)));
  };
  std::size_t const word = big_tiff ? 8 : 4, header = big_tiff ? 16 : 8;
  std::vector<std::array<std::uint64_t, 2>> const entries{{256, 2}, {257, 1}, {258, 8}, {259, 1},
                                                          {262, 1}, {273, 0}, {278, 1}, {279, 2}};
  std::size_t const directory = (big_tiff ? 8 : 2) + entries.size() * (big_tiff ? 20 : 12) + word, page = directory + 2;
  put(big_tiff ? 43 : 42, 2);
  if (big_tiff) put(8, 2), put(0, 2);
  put(header, word);
  for (std::size_t k = 0; k < pages; ++k) {
    std::size_t const start = header + k * page;
    put(entries.size(), big_tiff ? 8 : 2);
    for (auto const& [tag, value] : entries) {
      put(tag, 2);
      put(big_tiff ? 16 : 4, 2);  // type: integer of a word
      put(1, word);
      put(tag == 273 ? start + directory : value, word);
    }
    put(next(k) < pages ? header + next(k) * page : 0, word);
    put(k & 0xff, 1);
    put(k & 0xff, 1);
  }
  std::string const path = temporary(name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

// Recordings have thousands of pages. All kinds of TIFF have the offset of their first page at other places.
TEST(ImagePages, MayBeThousands) {
  constexpr std::size_t many = 3000;
  for (bool const big_endian : {false, true})
    for (bool const big_tiff : {false, true}) {
      ImagePages const pages(
          write_small_pages("many.tif", many, big_endian, big_tiff, [](std::size_t k) { return k + 1; }));
      ASSERT_EQ(pages.count(), many);
      for (std::size_t const page : {0u, 1u, 255u, 2999u}) EXPECT_EQ(pages.read(page)(1, 0), page & 0xff) << page;
    }
}

// A damaged file in which page 3 is followed by page 1 again has three pages.
TEST(ImagePages, EndWhereTheyRepeat) {
  for (bool const big_tiff : {false, true}) {
    ImagePages const pages(
        write_small_pages("cycle.tif", 5, false, big_tiff, [](std::size_t k) { return k == 2 ? 0 : k + 1; }));
    EXPECT_GE(pages.count(), 3u);
    EXPECT_LE(pages.count(), 4u) << "a page that the file declares, but that cannot be read, counts";
    EXPECT_EQ(pages.read(2)(0, 0), 2);
  }
}

TEST(ImagePages, OfAFileThatIsBeingWrittenAreRefused) {
  std::string const path = write_pages("growing.tif", {{8, 6}, {8, 6}});
  ImagePages const pages(path);
  std::ofstream(path, std::ios::app) << 'x';
  EXPECT_THAT([&] { pages.read(0); }, ThrowsDataError(ErrorCode::inconsistent, "growing.tif"));
}

/// Replaces a value in the header of a TIFF. @param tag  256: width, 257: height
std::string with_tag(std::string bytes, std::uint16_t tag, std::uint32_t value) {
  auto const number = [&](std::size_t place, std::size_t size) {
    std::uint32_t found = 0;
    for (std::size_t i = size; i-- > 0;) found = found << 8 | static_cast<unsigned char>(bytes[place + i]);
    return found;
  };
  std::size_t const directory = number(4, 4);
  for (std::size_t entry = 0; entry < number(directory, 2); ++entry) {
    std::size_t const place = directory + 2 + 12 * entry;
    if (number(place, 2) != tag) continue;
    bytes[place + 2] = 4;  // type with 32 bits
    for (std::size_t i = 0; i < 4; ++i) bytes[place + 8 + i] = static_cast<char>(value >> (8 * i) & 0xffu);
  }
  return bytes;
}

std::string case_path(std::string const& name) {
  return std::string(GLADSTONE_DATA_DIR "/../tests/cases/pictures/") + name;
}

/// Grey level of a pixel, by column and row, of an image in tests/cases/pictures (created by make.py there).
using Levels = double (*)(int, int);
double byte_level(int i, int j) { return 10 + 30 * i + 5 * j; }
double word_level(int i, int j) { return 1000 + 7000 * i + 1500 * j; }

/// Every image is read with the grey levels that were written and in upright orientation, for all orientations, byte
/// orders, sample types, compression methods and colour models. The tolerance is 0, except for
/// - the luminance of three equal colours, whose weights sum to 1 up to rounding,
/// - float_16, whose 11 bits round 0.75 by 2^-12,
/// - the levels of printing inks, whose 8 bits limit the accuracy,
/// - JPEG, whose discrete cosine transform rounds each of 64 coefficients by half a level; the errors rarely add up,
/// - a TIFF palette of 16 bits, of which the library retains 8: one level.
TEST(ImageFile, EveryKindOfPictureReadsAsItsLevels) {
  constexpr double rounding = 1e-9, jpeg = 2, palette = 1 + rounding;
  Levels const first_bits[] = {[](int i, int j) { return std::floor(byte_level(i, j) / 64); },
                               [](int i, int j) { return std::floor(byte_level(i, j) / 16); },
                               [](int i, int j) { return std::floor(word_level(i, j) / 64); },
                               [](int i, int j) { return std::floor(word_level(i, j) / 16); },
                               [](int i, int j) { return std::floor(word_level(i, j) / 4); }};
  Levels const white = [](int i, int j) { return byte_level(i, j) > 128 ? 1.0 : 0.0; };
  Levels const white_byte = [](int i, int j) { return byte_level(i, j) > 128 ? 255.0 : 0.0; };
  Levels const share = [](int i, int j) { return word_level(i, j) / 65535; };
  struct Kind {
    char const* name;
    Levels level;
    double tolerance;
  };
  for (Kind const &kind : std::initializer_list<Kind>{
           {"orientation_1.tif", byte_level, 0},
           {"orientation_2.tif", byte_level, 0},
           {"orientation_3.tif", byte_level, 0},
           {"orientation_4.tif", byte_level, 0},
           {"orientation_5.tif", byte_level, 0},
           {"orientation_6.tif", byte_level, 0},
           {"orientation_7.tif", byte_level, 0},
           {"orientation_8.tif", byte_level, 0},
           {"orientation_6.png", byte_level, 0},
           {"orientation_6.jpg", byte_level, jpeg},
           {"big_endian.tif", word_level, 0},
           {"bigtiff.tif", word_level, 0},
           {"tiled.tif", word_level, 0},
           {"predictor.tif", word_level, 0},
           {"compression_zstd.tif", byte_level, 0},
           {"compression_lzma.tif", byte_level, 0},
           {"compression_packbits.tif", byte_level, 0},
           {"compression_webp.tif", byte_level, rounding},
           {"bits_2.tif", first_bits[0], 0},
           {"bits_4.tif", first_bits[1], 0},
           {"bits_10.tif", first_bits[2], 0},
           {"bits_12.tif", first_bits[3], 0},
           {"bits_14.tif", first_bits[4], 0},
           {"bits_1.tif", white, 0},
           {"bits_1_group4.tif", white, 0},
           {"bits_1_white_is_zero.tif", white, 0},
           {"bits_1.png", white_byte, 0},
           {"white_is_zero_8.tif", byte_level, 0},
           {"white_is_zero_12.tif", first_bits[3], 0},
           {"white_is_zero_16.tif", word_level, 0},
           {"float_16.tif", share, 2.5e-4},
           {"float_32.tif", share, 6e-8},
           {"int_16.tif", [](int i, int j) { return word_level(i, j) - 30000; }, 0},
           {"uint_32.tif", [](int i, int j) { return 60000 * word_level(i, j); }, 0},
           {"palette.tif", byte_level, palette},
           {"palette.png", byte_level, rounding},
           {"palette.gif", byte_level, rounding},
           {"rgb.tif", byte_level, rounding},
           {"rgb_planar.tif", byte_level, rounding},
           {"rgba.tif", byte_level, rounding},
           {"grey_alpha.tif", byte_level, 0},
           {"grey_alpha.png", byte_level, 0},
           {"grey_16.png", word_level, 0},
           {"grey.jpg", byte_level, jpeg},
           {"ycbcr.tif", byte_level, jpeg},
           {"inks.tif", byte_level, rounding},
           {"inks_tiled.tif", byte_level, rounding},
           {"inks_planar.tif", byte_level, rounding},
           {"inks_jpeg.tif", byte_level, jpeg},
           {"inks_16_tiled.tif", [](int i, int j) { return 257 * byte_level(i, j); }, 1e-6},
       }) {
    Image<double> const image = read_image(case_path(kind.name));
    ASSERT_EQ(image.columns(), 7) << kind.name;
    ASSERT_EQ(image.rows(), 5) << kind.name;
    for (int j = 0; j < 5; ++j) {
      for (int i = 0; i < 7; ++i)
        EXPECT_NEAR(image(i, j), kind.level(i, j), kind.tolerance) << kind.name << ' ' << i << ' ' << j;
    }
  }
}

// Doubles retain all digits; OpenEXR stores half floats (11 bits: 0.1 is exact to 2^-15) and floats. Compression in
// OpenEXR and TIFF is lossless.
TEST(ImageFile, EveryFloatAndEveryPackingOfTiffKeepsItsValues) {
  auto const read = [](std::string const& path) {
    Image<double> const image = read_image(path);
    return std::vector<double>(image.begin(), image.end());
  };
  EXPECT_EQ(read(write_picture<double>("double.tif", {-1.5, 0.1, 1e-3, 1e9 / 3}, 2, 1)),
            (std::vector<double>{-1.5, 0.1, 1e-3, 1e9 / 3}));
  EXPECT_EQ(read(write_picture<float>("float.exr", {-1.5f, 0.1f, 1e6f, 3.0f}, 2, 1)),
            (std::vector<double>{-1.5, 0.1f, 1e6, 3}));
  std::string const half = temporary("half.exr");
  OIIO::ImageSpec const halves(2, 1, 1, OIIO::TypeDesc::HALF);
  float const stored[]{0.1f, 1024};
  auto const output = OIIO::ImageOutput::create(half);
  ASSERT_TRUE(output && output->open(half, halves) && output->write_image(OIIO::TypeDesc::FLOAT, stored));
  ASSERT_TRUE(output->close());
  EXPECT_NEAR(read(half)[0], 0.1, std::ldexp(1.0, -15));
  EXPECT_EQ(read(half)[1], 1024);

  auto const image = all_values();
  for (char const* packing : {"none", "lzw", "zip", "packbits"}) {
    std::string const path = temporary("packed.tif");
    OIIO::ImageSpec spec(256, 256, 1, OIIO::TypeDesc::UINT16);
    spec["compression"] = packing;
    auto const tiff = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(tiff && tiff->open(path, spec) && tiff->write_image(OIIO::TypeDesc::UINT16, image.data()));
    ASSERT_TRUE(tiff->close());
    auto const back = read_image(path);
    EXPECT_TRUE(std::equal(back.begin(), back.end(), image.begin(), image.end())) << packing;
  }
}

TEST(ImageFile, ReportsOrientationAndConversions) {
  ImageMetadata metadata;
  read_image(case_path("orientation_6.tif"), &metadata);
  EXPECT_EQ(metadata.orientation, 6);
  read_image(case_path("bits_1.tif"), &metadata);
  EXPECT_EQ(metadata.orientation, 1);
  EXPECT_EQ(metadata.bit_depth, 1);
  EXPECT_EQ(metadata.sample_bits, 1);
  read_image(case_path("inks_tiled.tif"), &metadata);
  EXPECT_EQ(metadata.channels, 3);
}

TEST(ImageFile, PicturesThatHaveNoGreyLevelsAreRefusedWithTheReason) {
  for (auto const& [name, code] : std::initializer_list<std::pair<char const*, ErrorCode>>{
           {"int_8.tif", ErrorCode::unsupported},
           {"uint_64.tif", ErrorCode::unsupported},
           {"complex.tif", ErrorCode::unsupported},
           {"compression_jpeg2000.tif", ErrorCode::damaged},
           {"inks_five_tiled.tif", ErrorCode::unsupported},
           {"channels_seven.tif", ErrorCode::unsupported},
           {"pages_3.tif", ErrorCode::wrong_shape},
       }) {
    std::string const path = case_path(name);
    EXPECT_THAT([&path] { read_image(path); }, ThrowsDataError(code, name)) << name;
  }
}

/// A TIFF of 256 x 200 px without the entry BitsPerSample, whose default is one bit.
/// @param packing, colours  its entries Compression and PhotometricInterpretation
std::string bilevel_tiff(std::uint32_t packing, std::uint32_t colours, std::string const& pixels) {
  constexpr std::uint32_t columns = 256, rows = 200, entries = 8, pixels_at = 10 + 12 * entries + 4;
  auto const pixel_bytes = static_cast<std::uint32_t>(pixels.size());
  std::uint32_t const entry[entries][2] = {{256, columns},   {257, rows}, {259, packing}, {262, colours},
                                           {273, pixels_at}, {277, 1},    {278, rows},    {279, pixel_bytes}};
  std::string bytes;
  auto const put = [&bytes](std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffu);
  };
  bytes += "II";
  put(42, 2);
  put(8, 4);
  put(entries, 2);
  for (auto const& [tag, value] : entry) {
    put(tag, 2);
    put(4, 2);  // type with 32 bits
    put(1, 4);
    put(value, 4);
  }
  put(0, 4);
  return bytes + pixels;
}

// 0x55 is 01010101: every second pixel of a row is white, starting with the second one.
TEST(ImageFile, OneBitAPixelIsReadWithoutTheEntryThatSaysSo) {
  constexpr std::uint32_t none = 1, packbits = 32773, black_is_zero = 1, rgb = 2;
  std::string const path = temporary("bits.tif"), row(256 / 8, '\x55');
  std::string plain, packed;
  for (int j = 0; j < 200; ++j) {
    plain += row;
    packed += std::string("\xe1\x55", 2);  // the byte 0x55 32 times (TIFF 6.0, section 9: 1 - 32 = -31)
  }
  for (std::string const& file :
       {bilevel_tiff(none, black_is_zero, plain), bilevel_tiff(packbits, black_is_zero, packed)}) {
    std::ofstream(path, std::ios::binary) << file;
    ImageMetadata metadata;
    Image<double> const image = read_image(path, &metadata);
    EXPECT_EQ(metadata.bit_depth, 1);
    ASSERT_EQ(image.columns(), 256);
    ASSERT_EQ(image.rows(), 200);
    for (int j = 0; j < 200; ++j) {
      for (int i = 0; i < 256; ++i) ASSERT_EQ(image(i, j), i % 2) << i << ' ' << j;
    }
  }
  std::ofstream(path, std::ios::binary) << bilevel_tiff(none, black_is_zero, plain.substr(0, plain.size() / 2));
  EXPECT_THAT([&] { read_image(path); }, ThrowsDataError(ErrorCode::damaged, "bits.tif"));
  std::ofstream(path, std::ios::binary) << bilevel_tiff(none, rgb, plain);
  EXPECT_THAT([&] { read_image(path); }, ThrowsDataError(ErrorCode::unsupported, "bits.tif"));
}

// 50,000 x 50,000 px of 16 bits are 5 GB, and 0.3 GB at the highest compression ratio, but the file has 128 kB.
TEST(ImageFile, AHeaderIsHeldAgainstTheSizeOfItsFile) {
  for (char const* packing : {"none", "zip", "lzw"}) {
    std::string const path = temporary("damaged.tif");
    OIIO::ImageSpec spec(256, 256, 1, OIIO::TypeDesc::UINT16);
    spec["compression"] = packing;
    auto const output = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(output->open(path, spec) && output->write_image(OIIO::TypeDesc::UINT16, all_values().data()));
    ASSERT_TRUE(output->close());
    std::string const bytes = with_tag(with_tag(content(path), 256, 50000), 257, 50000);
    std::ofstream(path, std::ios::binary) << bytes;
    EXPECT_THAT([&] { read_image(path); },
                ThrowsDataError(ErrorCode::damaged, "damaged.tif", HasSubstr("50000 x 50000 px")))
        << packing;
  }
}

// A tile of 50,000 x 50,000 px is 5 GB, while the image has 35 px.
TEST(ImageFile, TheTileSizeIsComparedWithTheSizeOfTheFile) {
  std::string const path = temporary("damaged_tiles.tif");
  constexpr std::uint16_t tile_width = 322, tile_length = 323;
  std::ofstream(path, std::ios::binary) << with_tag(with_tag(content(case_path("tiled.tif")), tile_width, 50000),
                                                    tile_length, 50000);
  EXPECT_THAT([&] { read_image(path); },
              ThrowsDataError(ErrorCode::damaged, "damaged_tiles.tif", HasSubstr("50000 x 50000")));
}

// A uniform grey image has the highest compression ratio of any image, a thousand to one.
TEST(ImageFile, DenselyPackedPicturesAreRead) {
  for (char const* name : {"even.png", "even.exr", "even.tif"}) {
    std::string const path = temporary(name);
    OIIO::ImageSpec spec(3000, 3000, 1, OIIO::TypeDesc::UINT16);
    spec["compression"] = "zip";
    auto const output = OIIO::ImageOutput::create(path);
    std::vector<std::uint16_t> const values(spec.image_pixels(), 0);
    ASSERT_TRUE(output->open(path, spec) && output->write_image(OIIO::TypeDesc::UINT16, values.data())) << name;
    ASSERT_TRUE(output->close());
    EXPECT_EQ(read_image(path).columns(), 3000) << name;
    fs::remove(path);
  }
}

TEST(ImageFile, PixelsThatAreNoNumbersAreCounted) {
  float const nan = std::nanf(""), infinite = HUGE_VALF;
  std::string const path = write_picture<float>("holes.tif", {1, nan, 2, infinite, -infinite, 3}, 3, 1);
  EXPECT_EQ(count_not_finite(read_image(path)), 3u);
}

TEST(ImageFile, FailureToWriteIsAnOutputError) {
  EXPECT_THAT([] { write_tiff("/dev/full", all_values(), {}); }, ThrowsOutputError("/dev/full"));
  EXPECT_THAT([] { write_tiff("/proc/no/such/folder/a.tif", all_values(), {}); }, ThrowsOutputError("/proc/no"));
  std::string const path = temporary("no_room.tif");
  write_tiff(path, all_values(), {});
  std::string const before = content(path);
  FileSizeLimit const limit(1000);
  EXPECT_THAT([&] { write_tiff(path, all_values(), {12, 0, "text"}); }, ThrowsOutputError("no_room.tif"));
  EXPECT_EQ(content(path), before);
}

}  // namespace
}  // namespace gladstone
