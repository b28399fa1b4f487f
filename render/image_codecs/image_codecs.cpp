#include "render/files/image_codecs.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

namespace gladstone::inline image_codecs {
namespace {

SampleType sample_type(OIIO::TypeDesc const& type) {
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
      return SampleType::uint8;
    case OIIO::TypeDesc::UINT16:
      return SampleType::uint16;
    case OIIO::TypeDesc::INT16:
      return SampleType::int16;
    case OIIO::TypeDesc::UINT32:
      return SampleType::uint32;
    case OIIO::TypeDesc::INT32:
      return SampleType::int32;
    case OIIO::TypeDesc::HALF:
    case OIIO::TypeDesc::FLOAT:
      return SampleType::float32;
    case OIIO::TypeDesc::DOUBLE:
      return SampleType::float64;
    default:
      return SampleType::other;
  }
}

OIIO::TypeDesc stored_as(SampleType type) {
  switch (type) {
    case SampleType::uint8:
      return OIIO::TypeDesc::UINT8;
    case SampleType::uint16:
      return OIIO::TypeDesc::UINT16;
    case SampleType::int16:
      return OIIO::TypeDesc::INT16;
    case SampleType::uint32:
      return OIIO::TypeDesc::UINT32;
    case SampleType::int32:
      return OIIO::TypeDesc::INT32;
    case SampleType::float32:
      return OIIO::TypeDesc::FLOAT;
    default:
      return OIIO::TypeDesc::DOUBLE;
  }
}

// PhotometricInterpretation of TIFF 6.0, section 8
constexpr int photometric_inverted = 0, photometric_grey = 1, photometric_palette = 3, photometric_inks = 5;

int photometric(OIIO::ImageSpec const& spec) { return spec.get_int_attribute("tiff:PhotometricInterpretation", -1); }

Colours colours_of(OIIO::ImageSpec const& spec) {
  switch (photometric(spec)) {
    case photometric_inverted:
    case photometric_grey:
      return Colours::grey;
    case photometric_inks:
      return Colours::inks;
    default:
      return Colours::by_count;
  }
}

/// Inverts unsigned samples of 16 and 32 bits; OpenImageIO inverts those of 8 bits.
void invert(OIIO::ImageSpec const& spec, void* samples) {
  if (spec.format != OIIO::TypeDesc::UINT16 && spec.format != OIIO::TypeDesc::UINT32) return;
  auto* const bytes = static_cast<unsigned char*>(samples);
  std::transform(bytes, bytes + spec.image_bytes(), bytes,
                 [](unsigned char byte) { return static_cast<unsigned char>(~byte); });
}

/// Returns a lower limit on the stored bits per pixel before compression.
double pixel_bits(OIIO::ImageSpec const& spec, int sample_bits, bool uncompressed) {
  if (photometric(spec) == photometric_palette) return spec.get_int_attribute("tiff:BitsPerSample", sample_bits);
  // Colour channels can have a lower resolution than brightness, and channels of EXR fewer bits than the widest one.
  constexpr double smallest_share = 0.25;
  return spec.nchannels * sample_bits * (uncompressed ? smallest_share : 1.0);
}

/// Returns the largest level that the header of a PNM file (.pgm, .ppm) declares; 0 for bitmaps and other formats.
std::uint64_t pnm_maximum(OIIO::ImageInput const& input, std::string const& path) {
  if (std::string_view(input.format_name()) != "pnm") return 0;
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  file >> magic;
  if (magic != "P2" && magic != "P3" && magic != "P5" && magic != "P6") return 0;
  std::uint64_t value = 0;
  for (int number = 0; number < 3; ++number) {  // columns, rows, largest level
    while ((file >> std::ws) && file.peek() == '#') file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    if (!(file >> value)) return 0;
  }
  return value;
}

/// Undoes the scaling of a PNM file's levels: OpenImageIO multiplies them by the largest number of their type, F,
/// divides by the largest level M, and drops the fraction, so that a level is the next integer from M / F times the
/// sample on. The result is shifted to the upper bits, as the interface requires.
template <class Sample>
void restore_levels(Sample* samples, std::size_t count, std::uint64_t maximum) {
  constexpr std::uint64_t full = std::numeric_limits<Sample>::max();
  if (maximum == 0 || maximum >= full) return;
  int const shift = static_cast<int>(8 * sizeof(Sample)) - static_cast<int>(std::bit_width(maximum));
  std::transform(samples, samples + count, samples,
                 [=](Sample sample) { return static_cast<Sample>((sample * maximum + full - 1) / full << shift); });
}

enum class InkColours { converted, stored };

std::unique_ptr<OIIO::ImageInput> open_input(std::string const& path, InkColours inks) {
  OIIO::ImageSpec configuration;
  // read unassociated alpha: colours as stored, not multiplied by their opacity
  configuration["oiio:UnassociatedAlpha"] = 1;
  if (inks == InkColours::stored) configuration["oiio:RawColor"] = 1;
  return OIIO::ImageInput::open(path, &configuration);
}

class OiioReader final : public PageReader {
 public:
  OiioReader(std::string path, std::unique_ptr<OIIO::ImageInput> input)
      : path_(std::move(path)), input_(std::move(input)), pnm_maximum_(pnm_maximum(*input_, path_)) {}

  bool seek(int page) override {
    if (is_past_end_ && !reopen()) return false;
    is_past_end_ = !input_->seek_subimage(page, 0);
    return !is_past_end_ && read_inks_as_stored();
  }

  PageHeader header() const override {
    OIIO::ImageSpec const spec = input_->spec();
    PageHeader header;
    header.width = spec.width;
    header.height = spec.height;
    header.depth = spec.depth;
    header.channels = spec.nchannels;
    header.type = sample_type(spec.format);
    header.type_name = spec.format.c_str();
    header.sample_bytes = spec.format.size();
    header.bits = spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(8 * spec.format.size()));
    if (pnm_maximum_ > 0) header.bits = std::min(header.bits, static_cast<int>(std::bit_width(pnm_maximum_)));
    header.compression = std::string(spec.get_string_attribute("compression", "unknown"));
    header.pixel_bits = pixel_bits(spec, header.bits, header.compression == "none");
    header.tile_px = {static_cast<double>(spec.tile_width), static_cast<double>(spec.tile_height),
                      static_cast<double>(spec.tile_depth)};
    header.description = std::string(spec.get_string_attribute("ImageDescription"));
    header.resolution = spec.get_float_attribute("XResolution");
    header.resolution_unit = std::string(spec.get_string_attribute("ResolutionUnit"));
    header.orientation = spec.get_int_attribute("Orientation", 1);
    header.colours = colours_of(spec);
    return header;
  }

  std::string read(void* samples) override {
    OIIO::ImageSpec const spec = input_->spec();
    bool const whole = input_->read_image(input_->current_subimage(), 0, 0, spec.nchannels,
                                          stored_as(sample_type(spec.format)), samples);
    // read_image() returns true for a truncated TIFF, and stores an error for every missing strip.
    if (whole && !input_->has_error()) {
      if (photometric(spec) == photometric_inverted) invert(spec, samples);
      if (spec.format == OIIO::TypeDesc::UINT8)
        restore_levels(static_cast<std::uint8_t*>(samples), spec.image_bytes(), pnm_maximum_);
      if (spec.format == OIIO::TypeDesc::UINT16)
        restore_levels(static_cast<std::uint16_t*>(samples), spec.image_bytes() / 2, pnm_maximum_);
      return "";
    }
    std::string const why = input_->geterror();
    return why.empty() ? "no reason given" : why.substr(0, why.find('\n'));
  }

  void clear_errors() override { input_->geterror(); }

 private:
  bool reopen() {
    auto again = open_input(path_, inks_);
    if (!again) return false;
    input_ = std::move(again);
    return true;
  }

  /// Reopens the file if its page consists of printing inks: the library's conversion to red, green and blue writes
  /// beyond its buffers if the page is stored in tiles (OpenImageIO 2.4, issue 5315).
  bool read_inks_as_stored() {
    if (inks_ == InkColours::stored || photometric(input_->spec()) != photometric_inks) return true;
    int const page = input_->current_subimage();
    inks_ = InkColours::stored;
    return reopen() && input_->seek_subimage(page, 0);
  }

  std::string path_;
  std::unique_ptr<OIIO::ImageInput> input_;
  InkColours inks_ = InkColours::converted;
  bool is_past_end_ = false;   ///< a page that does not exist was sought, after which WebP (2.4) reports errors
  std::uint64_t pnm_maximum_;  ///< largest level of a PNM file; 0: another format
};

class OiioCodecs final : public ImageCodecs {
 public:
  std::unique_ptr<PageReader> open(std::string const& path) const override {
    auto input = open_input(path, InkColours::converted);
    if (!input) {
      OIIO::geterror();
      return nullptr;
    }
    auto reader = std::make_unique<OiioReader>(path, std::move(input));
    return reader->seek(0) ? std::move(reader) : nullptr;
  }
};

}  // namespace
}  // namespace gladstone::inline image_codecs

extern "C" gladstone::ImageCodecs const* gladstone_image_codecs_3() {
  static gladstone::OiioCodecs const codecs;
  return &codecs;
}
