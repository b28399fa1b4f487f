#include "render/base/image_codecs.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace gladstone {
namespace {

SampleType sample_type(OIIO::TypeDesc type) {
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

class OiioReader final : public PageReader {
 public:
  explicit OiioReader(std::unique_ptr<OIIO::ImageInput> input) : input_(std::move(input)) {}

  bool seek(int page) override { return input_->seek_subimage(page, 0); }

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
    header.compression = std::string(spec.get_string_attribute("compression", "unknown"));
    header.tile_px = {static_cast<double>(spec.tile_width), static_cast<double>(spec.tile_height),
                      static_cast<double>(spec.tile_depth)};
    header.description = std::string(spec.get_string_attribute("ImageDescription"));
    header.resolution = spec.get_float_attribute("XResolution");
    header.resolution_unit = std::string(spec.get_string_attribute("ResolutionUnit"));
    return header;
  }

  bool read(void* samples) override {
    OIIO::ImageSpec const spec = input_->spec();
    bool const whole = input_->read_image(input_->current_subimage(), 0, 0, spec.nchannels,
                                          stored_as(sample_type(spec.format)), samples);
    // of a TIFF cut short it says true, and leaves an error for every missing strip
    bool const good = whole && !input_->has_error();
    if (!good) input_->geterror();
    return good;
  }

  void clear_errors() override { input_->geterror(); }

 private:
  std::unique_ptr<OIIO::ImageInput> input_;
};

class OiioCodecs final : public ImageCodecs {
 public:
  std::unique_ptr<PageReader> open(std::string const& path) const override {
    OIIO::ImageSpec configuration;
    configuration["oiio:UnassociatedAlpha"] = 1;  // colours as stored, not multiplied by their opacity
    auto input = OIIO::ImageInput::open(path, &configuration);
    if (!input) {
      OIIO::geterror();
      return nullptr;
    }
    return std::make_unique<OiioReader>(std::move(input));
  }

  std::string encode_tiff(std::string const& path, GreyPage const& page,
                          std::vector<unsigned char>& bytes) const override {
    OIIO::ImageSpec spec(page.columns, page.rows, 1, OIIO::TypeDesc::UINT16);
    spec["compression"] = "none";
    spec["ImageDescription"] = page.description;
    spec["Software"] = page.software;
    spec["DateTime"] = 0;  // not a text, so that no date is written: equal images are equal files
    if (page.pixels_per_centimetre > 0.0) {
      float const resolution = static_cast<float>(page.pixels_per_centimetre);
      spec["XResolution"] = resolution;
      spec["YResolution"] = resolution;
      spec["ResolutionUnit"] = "cm";
    }
    auto const output = OIIO::ImageOutput::create("tif");
    if (!output) return "no writer of TIFF is installed";
    OIIO::Filesystem::IOVecOutput memory(bytes);
    bool const written = output->set_ioproxy(&memory) && output->open(path, spec) &&
                         output->write_image(OIIO::TypeDesc::UINT16, page.values);
    return !output->close() || !written ? "out of memory?" : "";
  }

  std::string encode_png(int columns, int rows, std::uint8_t const* values,
                         std::vector<unsigned char>& bytes) const override {
    OIIO::ImageSpec const spec(columns, rows, 1, OIIO::TypeDesc::UINT8);
    auto const output = OIIO::ImageOutput::create("png");
    if (!output) return "no writer of PNG is installed";
    OIIO::Filesystem::IOVecOutput memory(bytes);
    bool const written = output->set_ioproxy(&memory) && output->open("picture.png", spec) &&
                         output->write_image(OIIO::TypeDesc::UINT8, values);
    return !output->close() || !written ? "out of memory?" : "";
  }
};

}  // namespace
}  // namespace gladstone

extern "C" gladstone::ImageCodecs const* gladstone_image_codecs() {
  static gladstone::OiioCodecs const codecs;
  return &codecs;
}
