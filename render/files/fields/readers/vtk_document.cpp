#include "render/files/fields/readers/vtk_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <utility>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/fields/readers/vtk_numbers.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

constexpr std::string_view appended = "<AppendedData";
constexpr std::size_t read_at_once = std::size_t{1} << 18;

/// XML part of a file, without the binary content of <AppendedData>.
struct Head {
  std::string xml;
  std::optional<std::uint64_t> data;  ///< offset of the appended data in the file [bytes]
};

Head read_head(InputFile const& file) {
  std::string text;
  while (true) {
    throw_if_interrupted();
    std::size_t const before = text.size();
    require_memory(file.path(), "its header", 3.0 * static_cast<double>(before + read_at_once));
    text.resize(before + read_at_once);
    text.resize(before + file.read(before, text.data() + before, read_at_once));
    bool const whole = text.size() < before + read_at_once;
    std::size_t const from = before > appended.size() ? before - appended.size() : 0;
    std::size_t const tag = text.find(appended, from);
    std::size_t const close = tag == std::string::npos ? tag : text.find('>', tag);
    std::size_t const mark = close == std::string::npos ? close : text.find('_', close);
    if (mark != std::string::npos) {
      text.resize(close);
      if (text.back() == '/') text.pop_back();
      return {text + "></AppendedData></VTKFile>", mark + 1};
    }
    if (whole) return {std::move(text), std::nullopt};
  }
}

}  // namespace

VtkDocument::VtkDocument(InputFile const& file) : file_(file), tree_(std::make_unique<pugi::xml_document>()) {
  Head head = read_head(file);
  xml_ = std::move(head.xml);
  appended_ = head.data;
  auto const result = tree_->load_buffer_inplace(xml_.data(), xml_.size());
  pugi::xml_node const root = tree_->child("VTKFile");
  if (!root) refuse(ErrorCode::wrong_format, "is not a VTK file (XML, with a tag <VTKFile>)");
  if (!result) {
    refuse(ErrorCode::damaged,
           fmt::format("is not complete XML ({} at byte {}); copy it again", result.description(), result.offset));
  }
  kind_ = root.attribute("type").as_string();
  read_encoding(root);
  appended_format_ = root.child("AppendedData").attribute("encoding").as_string("base64") == std::string_view("raw")
                         ? VtkPayload::Format::raw
                         : VtkPayload::Format::base64;
}

VtkDocument::~VtkDocument() = default;

void VtkDocument::refuse(ErrorCode code, std::string const& why) const { throw DataError(code, file_.path(), why); }

void VtkDocument::read_encoding(pugi::xml_node root) {
  encoding_.big_endian = root.attribute("byte_order").as_string() == std::string_view("BigEndian");
  encoding_.length_bytes = root.attribute("header_type").as_string() == std::string_view("UInt64") ? 8 : 4;
  std::string const compressor = root.attribute("compressor").as_string();
  if (compressor == "vtkZLibDataCompressor") encoding_.compressor = VtkEncoding::Compressor::zlib;
  if (compressor == "vtkLZ4DataCompressor") encoding_.compressor = VtkEncoding::Compressor::lz4;
  if (compressor == "vtkLZMADataCompressor") encoding_.compressor = VtkEncoding::Compressor::lzma;
  if (!compressor.empty() && encoding_.compressor == VtkEncoding::Compressor::none) {
    refuse(ErrorCode::unsupported,
           fmt::format("is compressed by \"{}\", which is not supported; use zlib, LZ4, LZMA or none",
                       excerpt(compressor)));
  }
}

bool VtkDocument::states_byte_order() const { return !tree_->child("VTKFile").attribute("byte_order").empty(); }

pugi::xml_node VtkDocument::data_set() const {
  pugi::xml_node const set = tree_->child("VTKFile").child(kind_.c_str());
  if (!set) refuse(ErrorCode::damaged, "has no tag <" + excerpt(kind_) + ">; copy it again");
  return set;
}

void VtkDocument::read_array(pugi::xml_node tag, VtkPiece& piece) const {
  std::string_view const type = tag.attribute("type").as_string();
  std::string const name = tag.attribute("Name").as_string();
  auto const* const number =
      std::find_if(vtk_numbers.begin(), vtk_numbers.end(), [type](VtkNumber const& one) { return one.xml == type; });
  if (number == vtk_numbers.end()) {
    refuse(ErrorCode::wrong_type,
           fmt::format("data array \"{}\" is of type \"{}\", which is not numeric", excerpt(name), excerpt(type)));
  }
  piece.number = *number;
  VtkPayload& payload = piece.payload;
  std::string_view const format = tag.attribute("format").as_string("ascii");
  payload.appended = format == "appended";
  if (payload.appended) {
    if (!appended_)
      refuse(ErrorCode::damaged, fmt::format("data array \"{}\" has no data; copy it again", excerpt(name)));
    payload.format = appended_format_;
    std::string const attribute = fmt::format("{} offset", tag.name());
    payload.offset = *appended_ + parse_vtk_numbers<std::uint64_t, 1>(tag.attribute("offset").as_string(), file_.path(),
                                                                      attribute)[0];
    if (payload.offset < *appended_) refuse(ErrorCode::damaged, "has an impossible offset; copy it again");
    return;
  }
  payload.format = format == "ascii" ? VtkPayload::Format::ascii : VtkPayload::Format::base64;
  // comments divide the text into several nodes
  for (pugi::xml_node const text : tag.children()) payload.text += text.value();
}

void refuse_vtk_numbers(std::string const& path, std::string const& attribute, std::string_view text,
                        std::size_t count) {
  throw DataError(ErrorCode::syntax, path,
                  fmt::format("{} = \"{}\" is not {} numbers", attribute, excerpt(text), count));
}

}  // namespace gladstone::inline files
