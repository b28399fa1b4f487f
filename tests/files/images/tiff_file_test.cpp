#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "render/base/error.h"
#include "render/files/image_file.h"
#include "render/files/tiff_reader.h"
#include "render/files/tiff_writer.h"
#include "tests/files/support/output.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

/// Storage of a page that libtiff writes.
struct PageLayout {
  int bits = 8, format = SAMPLEFORMAT_UINT, channels = 1;
  int photometric = PHOTOMETRIC_MINISBLACK;
  int compression = COMPRESSION_NONE, predictor = PREDICTOR_NONE;
  bool tiled = false, separate = false, big_endian = false, big_tiff = false;
  int fill_order = FILLORDER_MSB2LSB;
};

std::ostream& operator<<(std::ostream& out, PageLayout const& page) {
  return out << page.bits << " bits, format " << page.format << ", channels " << page.channels << ", photometric "
             << page.photometric << ", compression " << page.compression << ", predictor " << page.predictor
             << (page.tiled ? ", tiles" : ", strips") << (page.separate ? ", separate" : ", interleaved")
             << (page.big_endian ? ", big endian" : "") << (page.big_tiff ? ", BigTIFF" : "")
             << (page.fill_order == FILLORDER_LSB2MSB ? ", least significant bit first" : "");
}

constexpr int page_columns = 37, page_rows = 21;  // neither a multiple of the tile size nor of the rows per strip
constexpr int tile_side = 16, rows_per_strip = 8;

int bytes_as_read(int bits) { return bits <= 8 ? 1 : bits <= 16 ? 2 : bits / 8; }

/// Bits of sample `channel` of a pixel: a pattern without a period in common with rows, tiles or bytes. Floats are
/// finite, since the upper bits of their exponent are those of numbers near 1.
std::uint64_t sample_bits(PageLayout const& page, int column, int row, int channel) {
  if (page.format == SAMPLEFORMAT_IEEEFP) {
    double const value = 1.0 + column / 64.0 - row / 7.0 + 10 * channel;
    auto const narrow = static_cast<float>(value);
    std::uint64_t bits = 0;
    std::memcpy(&bits, page.bits == 32 ? static_cast<void const*>(&narrow) : &value,
                static_cast<std::size_t>(page.bits / 8));
    return bits;
  }
  std::uint64_t const mixed =
      (std::uint64_t(row * page_columns + column) * 5 + std::uint64_t(channel) + 1) * std::uint64_t{0x9e3779b97f4a7c15};
  return mixed >> (64 - page.bits);
}

/// A row of samples as libtiff takes them: packed, most significant bit first, or in the byte order of this machine.
/// @param first, count  columns of the row; columns beyond the page repeat its last one
/// @param plane         channel, or -1 for all of them
std::vector<unsigned char> packed_row(PageLayout const& page, int first, int count, int row, int plane) {
  int const from = std::max(plane, 0), to = plane < 0 ? page.channels : plane + 1;
  std::vector<unsigned char> bytes((static_cast<std::size_t>(count * (to - from) * page.bits) + 7) / 8);
  std::size_t bit = 0;
  for (int column = first; column < first + count; ++column) {
    for (int channel = from; channel < to; ++channel, bit += static_cast<std::size_t>(page.bits)) {
      std::uint64_t const value =
          sample_bits(page, std::min(column, page_columns - 1), std::min(row, page_rows - 1), channel);
      if (page.bits % 8 == 0) {
        std::memcpy(bytes.data() + bit / 8, &value, static_cast<std::size_t>(page.bits / 8));
        continue;
      }
      for (int i = 0; i < page.bits; ++i) {
        std::size_t const place = bit + static_cast<std::size_t>(i);
        if ((value >> (page.bits - 1 - i) & 1) != 0) bytes[place / 8] |= static_cast<unsigned char>(0x80 >> place % 8);
      }
    }
  }
  return bytes;
}

void write_block(TIFF* file, PageLayout const& page, int x, int y, int plane) {
  int const columns = page.tiled ? tile_side : page_columns;
  int const rows = page.tiled ? tile_side : std::min(rows_per_strip, page_rows - y);
  std::vector<unsigned char> block;
  for (int row = y; row < y + rows; ++row) {
    auto const packed = packed_row(page, x, columns, row, plane);
    block.insert(block.end(), packed.begin(), packed.end());
  }
  auto const size = static_cast<tmsize_t>(block.size());
  auto const column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
  auto const sample = static_cast<std::uint16_t>(std::max(plane, 0));
  tmsize_t const written =
      page.tiled ? TIFFWriteEncodedTile(file, TIFFComputeTile(file, column, row, 0, sample), block.data(), size)
                 : TIFFWriteEncodedStrip(file, TIFFComputeStrip(file, row, sample), block.data(), size);
  EXPECT_EQ(written, size) << page;
}

void write_layout(std::string const& path, PageLayout const& page) {
  std::string const mode = std::string("w") + (page.big_endian ? 'b' : 'l') + (page.big_tiff ? "8" : "");
  std::unique_ptr<TIFF, decltype(&TIFFClose)> const file(TIFFOpen(path.c_str(), mode.c_str()), &TIFFClose);
  ASSERT_TRUE(file) << page;
  TIFFSetField(file.get(), TIFFTAG_IMAGEWIDTH, page_columns);
  TIFFSetField(file.get(), TIFFTAG_IMAGELENGTH, page_rows);
  TIFFSetField(file.get(), TIFFTAG_BITSPERSAMPLE, page.bits);
  TIFFSetField(file.get(), TIFFTAG_SAMPLEFORMAT, page.format);
  TIFFSetField(file.get(), TIFFTAG_SAMPLESPERPIXEL, page.channels);
  TIFFSetField(file.get(), TIFFTAG_PHOTOMETRIC, page.photometric);
  TIFFSetField(file.get(), TIFFTAG_PLANARCONFIG, page.separate ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
  TIFFSetField(file.get(), TIFFTAG_COMPRESSION, page.compression);
  TIFFSetField(file.get(), TIFFTAG_FILLORDER, page.fill_order);
  if (page.predictor != PREDICTOR_NONE) TIFFSetField(file.get(), TIFFTAG_PREDICTOR, page.predictor);
  TIFFSetField(file.get(), TIFFTAG_ORIENTATION, ORIENTATION_BOTLEFT);
  TIFFSetField(file.get(), TIFFTAG_IMAGEDESCRIPTION, "an image");
  TIFFSetField(file.get(), TIFFTAG_XRESOLUTION, 2000.0);
  TIFFSetField(file.get(), TIFFTAG_YRESOLUTION, 2000.0);
  TIFFSetField(file.get(), TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
  if (page.tiled) {
    TIFFSetField(file.get(), TIFFTAG_TILEWIDTH, tile_side);
    TIFFSetField(file.get(), TIFFTAG_TILELENGTH, tile_side);
  } else {
    TIFFSetField(file.get(), TIFFTAG_ROWSPERSTRIP, rows_per_strip);
  }
  for (int plane = page.separate ? 0 : -1; plane < (page.separate ? page.channels : 0); ++plane) {
    for (int y = 0; y < page_rows; y += page.tiled ? tile_side : rows_per_strip) {
      for (int x = 0; x < page_columns; x += page.tiled ? tile_side : page_columns)
        write_block(file.get(), page, x, y, plane);
    }
  }
}

/// Bits of all samples that a reader returns, without the scaling to the range of their type.
std::vector<std::uint64_t> read_bits(PageReader& reader, PageLayout const& page) {
  auto const bytes = static_cast<std::size_t>(bytes_as_read(page.bits));
  auto const count = static_cast<std::size_t>(page_columns * page_rows * page.channels);
  std::vector<unsigned char> samples(count * bytes);
  EXPECT_EQ(reader.read(samples.data()), "") << page;
  std::vector<std::uint64_t> values(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&values[i], samples.data() + i * bytes, bytes);
    values[i] >>= 8 * bytes - static_cast<std::size_t>(page.bits);
  }
  return values;
}

std::vector<std::uint64_t> written_bits(PageLayout const& page) {
  bool const inverted = page.photometric == PHOTOMETRIC_MINISWHITE && page.format == SAMPLEFORMAT_UINT;
  std::uint64_t const white = inverted ? ~std::uint64_t{0} >> (64 - page.bits) : 0;
  std::vector<std::uint64_t> values;
  for (int row = 0; row < page_rows; ++row) {
    for (int column = 0; column < page_columns; ++column) {
      for (int channel = 0; channel < page.channels; ++channel)
        values.push_back(sample_bits(page, column, row, channel) ^ white);
    }
  }
  return values;
}

void expect_equal_headers(PageHeader const& ours, PageHeader const& theirs, PageLayout const& page) {
  EXPECT_EQ(ours.width, theirs.width) << page;
  EXPECT_EQ(ours.height, theirs.height) << page;
  EXPECT_EQ(ours.depth, theirs.depth) << page;
  EXPECT_EQ(ours.channels, theirs.channels) << page;
  EXPECT_EQ(ours.type, theirs.type) << page;
  EXPECT_EQ(ours.sample_bytes, theirs.sample_bytes) << page;
  EXPECT_EQ(ours.bits, theirs.bits) << page;
  EXPECT_EQ(ours.compression == "none", theirs.compression == "none") << page;
  EXPECT_EQ(ours.description, theirs.description) << page;
  EXPECT_EQ(ours.resolution, theirs.resolution) << page;
  EXPECT_EQ(ours.resolution_unit, theirs.resolution_unit) << page;
  EXPECT_EQ(ours.orientation, theirs.orientation) << page;
  EXPECT_EQ(ours.colours, theirs.colours) << page;
}

class TiffFile : public Output {
 protected:
  /// Writes a page, and expects that open_tiff() reads the samples and the header.
  void expect_read(PageLayout const& page) const {
    std::string const path = in_folder("page.tif");
    write_layout(path, page);
    InputFile const file(path);
    auto const reader = open_tiff(file);
    ASSERT_TRUE(reader) << page;
    EXPECT_EQ(read_bits(*reader, page), written_bits(page)) << page;
    PageHeader const header = reader->header();
    EXPECT_EQ(header.width, page_columns) << page;
    EXPECT_EQ(header.bits, page.bits) << page;
    EXPECT_EQ(header.orientation, ORIENTATION_BOTLEFT) << page;
    EXPECT_EQ(header.sample_bytes, static_cast<std::uint64_t>(bytes_as_read(page.bits))) << page;
  }

  /// Like expect_read(), and expects the same samples and header from OpenImageIO. Its version 2.4 misreads separate
  /// planes of fewer bits than their type, and tiles of 64 bits.
  void expect_read_as_by_openimageio(PageLayout const& page) const {
    expect_read(page);
    if ((page.separate && page.bits % 8 != 0) || (page.tiled && page.bits == 64)) return;
    std::string const path = in_folder("page.tif");
    InputFile const file(path);
    std::unique_ptr<PageReader> const ours = open_tiff(file), theirs = loaded_image_codecs().open(path);
    ASSERT_TRUE(ours && theirs) << page;
    EXPECT_EQ(read_bits(*theirs, page), written_bits(page)) << page;
    expect_equal_headers(ours->header(), theirs->header(), page);
  }
};

/// Types of samples that TIFFs of cameras and of other programs have.
std::vector<PageLayout> const& sample_layouts() {
  static std::vector<PageLayout> const all{{1},
                                           {2},
                                           {4},
                                           {6},
                                           {8},
                                           {10},
                                           {12},
                                           {14},
                                           {16},
                                           {32},
                                           {16, SAMPLEFORMAT_INT},
                                           {32, SAMPLEFORMAT_INT},
                                           {32, SAMPLEFORMAT_IEEEFP},
                                           {64, SAMPLEFORMAT_IEEEFP}};
  return all;
}

TEST_F(TiffFile, SamplesOfEveryTypeAndByteOrderAreReadFromStripsTilesAndPlanes) {
  for (PageLayout page : sample_layouts()) {
    for (int const channels : {1, 2, 3, 4}) {
      page.channels = channels;
      page.photometric = channels < 3 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
      for (int const variant : {0, 1, 2, 3, 4, 5, 6, 7}) {
        page.tiled = (variant & 1) != 0;
        page.separate = (variant & 2) != 0;
        page.big_endian = (variant & 4) != 0;
        if (page.separate && channels == 1) continue;
        expect_read_as_by_openimageio(page);
      }
    }
  }
}

// FillOrder = 2 (TIFF 6.0, section 8): the bits of each byte are stored in reverse order, after compression.
TEST_F(TiffFile, PackedSamplesAreReadInBothOrdersOfBits) {
  for (int const compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS}) {
    for (int const bits : {1, 4, 8, 10, 12, 14, 16}) {
      for (int const variant : {0, 1, 2, 3}) {
        PageLayout page{bits};
        page.compression = compression;
        page.fill_order = FILLORDER_LSB2MSB;
        page.tiled = (variant & 1) != 0;
        page.big_endian = (variant & 2) != 0;
        expect_read(page);
      }
    }
  }
}

/// Returns a TIFF of one strip with 3 x 2 packed samples, written byte by byte according to TIFF 6.0.
std::string packed_by_hand(int bits, int fill_order, std::string const& samples) {
  auto const number = [](std::uint32_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text.push_back(static_cast<char>(value >> 8 * i & 0xff));
    return text;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> const entries{{256, 3}, {257, 2}, {258, bits},
                                                                     {259, 1}, {262, 1}, {266, fill_order},
                                                                     {273, 8}, {278, 2}, {279, samples.size()}};
  std::string text = "II" + number(42, 2) + number(8 + static_cast<std::uint32_t>(samples.size()), 4) + samples +
                     number(static_cast<std::uint32_t>(entries.size()), 2);
  for (auto const& [tag, value] : entries) text += number(tag, 2) + number(4, 2) + number(1, 4) + number(value, 4);
  return text + number(0, 4);
}

// Samples are packed from the most significant bit on, and each row begins at a byte: 0x123 0x456 0x789 are the bytes
// 12 34 56 78 90, reversed bit by bit 48 2c 6a 1e 09.
TEST_F(TiffFile, TwelveBitsPackedByHandAreRead) {
  std::string const path = in_folder("hand.tif");
  for (auto const& [fill_order, samples] :
       {std::pair{1, std::string("\x12\x34\x56\x78\x90\xab\xcd\xef\x00\x10", 10)},
        std::pair{2, std::string("\x48\x2c\x6a\x1e\x09\xd5\xb3\xf7\x00\x08", 10)}}) {
    std::ofstream(path, std::ios::binary) << packed_by_hand(12, fill_order, samples);
    ImageMetadata metadata;
    Image<double> const image = read_image(path, &metadata);
    EXPECT_EQ(metadata.bit_depth, 12);
    EXPECT_THAT(std::vector<double>(image.begin(), image.end()),
                testing::ElementsAre(0x123, 0x456, 0x789, 0xabc, 0xdef, 0x001));
  }
}

TEST_F(TiffFile, SamplesOfOddNumbersOfBitsAreRead) {
  for (int const bits : {3, 5, 7, 9, 11, 13, 15}) {
    for (bool const tiled : {false, true}) {
      PageLayout page{bits};
      page.tiled = tiled;
      expect_read(page);
    }
  }
}

TEST_F(TiffFile, EveryLosslessCompressionIsRead) {
  for (int const compression : {COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_DEFLATE, COMPRESSION_PACKBITS,
                                COMPRESSION_LZMA, COMPRESSION_ZSTD}) {
    if (TIFFIsCODECConfigured(static_cast<std::uint16_t>(compression)) == 0) continue;
    bool const predicts = compression != COMPRESSION_PACKBITS;
    for (PageLayout page : sample_layouts()) {
      page.compression = compression;
      for (bool const tiled : {false, true}) {
        page.tiled = tiled;
        page.big_endian = !tiled;
        page.predictor = PREDICTOR_NONE;
        expect_read_as_by_openimageio(page);
        if (!predicts || page.bits % 8 != 0 || page.bits == 64) continue;
        bool const floating = page.format == SAMPLEFORMAT_IEEEFP;
        page.predictor = floating ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL;
        if (floating) page.big_endian = false;  // libtiff 4.5 writes predicted floats in its own byte order
        expect_read_as_by_openimageio(page);
      }
    }
  }
  for (int const compression : {COMPRESSION_CCITTRLE, COMPRESSION_CCITTFAX3, COMPRESSION_CCITTFAX4}) {
    PageLayout page{1};
    page.compression = compression;
    page.photometric = PHOTOMETRIC_MINISWHITE;
    expect_read_as_by_openimageio(page);
  }
}

// Both readers decode JPEG by the same library. OpenImageIO turns grey pages upright, so that their rows are reversed.
TEST_F(TiffFile, JpegIsReadAsByOpenImageIo) {
  for (int const channels : {1, 3}) {
    PageLayout page{8, SAMPLEFORMAT_UINT, channels, channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB};
    page.compression = COMPRESSION_JPEG;
    std::string const path = in_folder("jpeg.tif");
    write_layout(path, page);
    InputFile const file(path);
    std::unique_ptr<PageReader> const ours = open_tiff(file), theirs = loaded_image_codecs().open(path);
    ASSERT_TRUE(ours && theirs);
    std::vector<std::uint64_t> expected = read_bits(*theirs, page);
    if (channels == 1) {
      for (int row = 0; row < page_rows / 2; ++row) {
        auto const top = expected.begin() + row * page_columns;
        std::swap_ranges(top, top + page_columns, expected.end() - (row + 1) * page_columns);
      }
    }
    EXPECT_EQ(read_bits(*ours, page), expected) << page;
  }
}

TEST_F(TiffFile, WhiteIsTheLargerValue) {
  for (PageLayout page : sample_layouts()) {
    page.photometric = PHOTOMETRIC_MINISWHITE;
    expect_read_as_by_openimageio(page);
    page.tiled = true;
    expect_read_as_by_openimageio(page);
  }
}

TEST_F(TiffFile, PrintingInksAreReadAsStored) {
  for (int const bits : {8, 16}) {
    for (int const variant : {0, 1, 2, 3}) {
      PageLayout page{bits, SAMPLEFORMAT_UINT, 4, PHOTOMETRIC_SEPARATED};
      page.tiled = (variant & 1) != 0;
      page.separate = (variant & 2) != 0;
      page.big_tiff = page.tiled;
      expect_read_as_by_openimageio(page);
    }
  }
}

TEST_F(TiffFile, FilesOfOpenImageIoAreReadAsByOpenImageIo) {
  for (char const* compression : {"none", "lzw", "zip", "packbits", "zstd"}) {
    for (int const tile : {0, 16}) {
      for (OIIO::TypeDesc const type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16, OIIO::TypeDesc::FLOAT}) {
        std::string const path = in_folder("openimageio.tif");
        OIIO::ImageSpec spec(page_columns, page_rows, 3, type);
        spec["compression"] = compression;
        spec.tile_width = spec.tile_height = tile;
        std::vector<float> samples(spec.image_pixels() * 3);
        std::iota(samples.begin(), samples.end(), 0.0f);
        for (float& sample : samples) sample /= static_cast<float>(samples.size());
        auto const output = OIIO::ImageOutput::create(path);
        ASSERT_TRUE(output->open(path, spec) && output->write_image(OIIO::TypeDesc::FLOAT, samples.data()));
        ASSERT_TRUE(output->close());
        InputFile const file(path);
        std::unique_ptr<PageReader> const ours = open_tiff(file), theirs = loaded_image_codecs().open(path);
        ASSERT_TRUE(ours && theirs) << compression;
        std::vector<unsigned char> one(spec.image_bytes()), other(spec.image_bytes());
        EXPECT_EQ(ours->read(one.data()), "") << compression;
        EXPECT_EQ(theirs->read(other.data()), "") << compression;
        EXPECT_EQ(one, other) << compression << ' ' << tile << ' ' << type.c_str();
      }
    }
  }
}

TEST_F(TiffFile, OtherLayoutsAreLeftToOpenImageIo) {
  for (char const* name : {"palette.tif", "ycbcr.tif", "float_16.tif", "int_8.tif", "uint_64.tif", "complex.tif",
                           "compression_jpeg2000.tif", "palette.png"}) {
    InputFile const file(std::string(GLADSTONE_DATA_DIR "/../tests/cases/pictures/") + name);
    EXPECT_EQ(open_tiff(file), nullptr) << name;
  }
  PageLayout const ycbcr{8, SAMPLEFORMAT_UINT, 3, PHOTOMETRIC_YCBCR};
  write_layout(in_folder("ycbcr.tif"), ycbcr);
  InputFile const file(in_folder("ycbcr.tif"));
  EXPECT_EQ(open_tiff(file), nullptr);
}

/// An encoded image of every 16-bit value.
std::vector<unsigned char> encode_all_values(GreyPage page, std::vector<std::uint16_t>& values) {
  values.resize(65536);
  std::iota(values.begin(), values.end(), std::uint16_t{0});
  page.columns = 512;
  page.rows = 128;
  page.values = values.data();
  return encode_tiff("all.tif", page);
}

TEST_F(TiffFile, OpenImageIoReadsTheEncodedImageWithItsMetadata) {
  std::vector<std::uint16_t> values;
  std::vector<unsigned char> const bytes =
      encode_all_values({0, 0, nullptr, "a text\nof two lines \xc3\xa4", "gladstone 1", 1538.5}, values);
  std::string const path = in_folder("encoded.tif");
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<char const*>(bytes.data()), std::ssize(bytes));
  auto const input = OIIO::ImageInput::open(path);
  ASSERT_TRUE(input);
  OIIO::ImageSpec const& spec = input->spec();
  EXPECT_EQ(spec.width, 512);
  EXPECT_EQ(spec.height, 128);
  EXPECT_EQ(spec.nchannels, 1);
  EXPECT_EQ(spec.format, OIIO::TypeDesc::UINT16);
  EXPECT_EQ(spec.get_int_attribute("oiio:BitsPerSample"), 16);
  EXPECT_EQ(spec.get_string_attribute("compression"), "none");
  EXPECT_EQ(spec.get_string_attribute("ImageDescription"), "a text\nof two lines \xc3\xa4");
  EXPECT_EQ(spec.get_string_attribute("Software"), "gladstone 1");
  EXPECT_EQ(spec.get_float_attribute("XResolution"), 1538.5f);
  EXPECT_EQ(spec.get_float_attribute("YResolution"), 1538.5f);
  EXPECT_EQ(spec.get_string_attribute("ResolutionUnit"), "cm");
  EXPECT_EQ(spec.get_int_attribute("Orientation"), 1);
  EXPECT_EQ(spec.get_int_attribute("tiff:PhotometricInterpretation"), PHOTOMETRIC_MINISBLACK);
  EXPECT_EQ(spec.get_string_attribute("planarconfig"), "contig");
  EXPECT_EQ(spec.find_attribute("DateTime"), nullptr);
  std::vector<std::uint16_t> read(values.size());
  ASSERT_TRUE(input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT16, read.data()));
  EXPECT_EQ(read, values);
  EXPECT_FALSE(input->seek_subimage(1, 0));
}

TEST_F(TiffFile, WithoutAPixelPitchNoResolutionIsStored) {
  std::vector<std::uint16_t> values;
  std::vector<unsigned char> const bytes = encode_all_values({}, values);
  std::string const path = in_folder("encoded.tif");
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<char const*>(bytes.data()), std::ssize(bytes));
  auto const input = OIIO::ImageInput::open(path);
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().find_attribute("XResolution"), nullptr);
  EXPECT_EQ(input->spec().find_attribute("ResolutionUnit"), nullptr);
}

TEST_F(TiffFile, AnImageWithoutPixelsCannotBeEncoded) {
  EXPECT_THAT([] { encode_tiff("empty.tif", {}); }, ThrowsOutputError("empty.tif"));
}

// By default, libtiff prints its errors and warnings.
TEST_F(TiffFile, DamagedFilesAreNamedAndNothingIsPrinted) {
  std::vector<std::uint16_t> values;
  std::vector<unsigned char> const bytes = encode_all_values({}, values);
  std::string const whole(bytes.begin(), bytes.end());
  testing::internal::CaptureStderr();
  for (std::size_t const size :
       {whole.size() - 1, whole.size() - 100, whole.size() / 2, std::size_t{300}, std::size_t{8}}) {
    std::string const path = in_folder("cut.tif");
    std::ofstream(path, std::ios::binary) << whole.substr(0, size);
    EXPECT_THAT([&] { read_image(path); }, testing::AnyOf(ThrowsDataError(ErrorCode::damaged, "cut.tif"),
                                                          ThrowsDataError(ErrorCode::wrong_format, "cut.tif")))
        << size;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// PackBits decodes any bytes.
TEST_F(TiffFile, DamagedStripsAreReported) {
  for (int const compression : {COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_ZSTD}) {
    PageLayout page{16};
    page.compression = compression;
    std::string const path = in_folder("damaged.tif");
    write_layout(path, page);
    std::string bytes = content(path);
    std::fill(bytes.begin() + 8, bytes.begin() + 600, '\xff');  // the strips follow the header of 8 bytes
    std::ofstream(path, std::ios::binary) << bytes;
    EXPECT_THAT([&] { read_image(path); }, ThrowsDataError(ErrorCode::damaged, "damaged.tif")) << compression;
  }
}

}  // namespace
}  // namespace gladstone
