#include "render/files/input_guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "render/files/file_kind.h"
#include "render/files/hdf5_file.h"
#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "render/files/text_file.h"
#include "tests/files/support/output.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Fixture: the input files of a command must not be replaced by its outputs.
class InputGuards : public Output {
 protected:
  void SetUp() override {
    Output::SetUp();
    std::ofstream(in_folder("input.txt")) << "precious";
  }
};

TEST_F(InputGuards, RefuseInputsAsOutputsUnderEveryName) {
  fs::create_symlink("input.txt", in_folder("link.txt"));
  fs::create_hard_link(in_folder("input.txt"), in_folder("hard.txt"));
  InputGuard const guard;
  std::thread([&] { read_text_file(in_folder("input.txt")); }).join();  // reading in any thread counts
  for (std::string const name : {"input.txt", "link.txt", "hard.txt"}) {
    EXPECT_THAT([&] { OutputFile::write_text(in_folder(name), "new"); },
                ThrowsOutputError(name, ErrorCode::overwrites_input))
        << name;
  }
  EXPECT_THAT([&] { OutputFile(in_folder("link.txt")); }, ThrowsOutputError("link.txt", ErrorCode::overwrites_input));
  EXPECT_EQ(content(in_folder("input.txt")), "precious");
  OutputFile::write_text(in_folder("other.txt"), "new");
}

TEST_F(InputGuards, InputReadLaterIsProtectedAtCommit) {
  InputGuard const guard;
  OutputFile output(in_folder("input.txt"));
  read_text_file(in_folder("input.txt"));
  output.write("new", 3);
  EXPECT_THAT([&] { output.commit(); }, ThrowsOutputError("input.txt", ErrorCode::overwrites_input));
  EXPECT_EQ(content(in_folder("input.txt")), "precious");
}

TEST_F(InputGuards, AFolderThatReplacesAnInputStaysAsItWas) {
  fs::create_directory(in_folder("case"));
  std::ofstream(in_folder("case/marker")) << "old";
  std::ofstream(in_folder("case/derived.csv")) << "precious";
  InputGuard const guard;
  read_text_file(in_folder("case/derived.csv"));
  OutputFolder output(in_folder("case"), {"marker", {"derived.csv"}});
  OutputFile::write_text(output.temporary_path() + "/marker", "new");
  EXPECT_THAT([&] { output.commit(); }, ThrowsOutputError("derived.csv", ErrorCode::overwrites_input));
  EXPECT_EQ(content(in_folder("case/marker")), "old");
  EXPECT_EQ(content(in_folder("case/derived.csv")), "precious");
}

TEST_F(InputGuards, OwnOutputIsNoInput) {
  InputGuard const guard;
  for (std::string const text : {"one", "two", "three"}) {
    OutputFile::write_text(in_folder("own.txt"), text);
    EXPECT_EQ(read_text_file(in_folder("own.txt")), text);
  }
  {
    UnrecordedReading const to_be_replaced;
    read_text_file(in_folder("input.txt"));
  }
  OutputFile::write_text(in_folder("input.txt"), "new");
}

TEST_F(InputGuards, RecordsOnlyUnderGuard) {
  {
    InputGuard const guard;
    read_text_file(in_folder("input.txt"));
  }
  read_text_file(in_folder("input.txt"));
  InputGuard const guard;
  OutputFile::write_text(in_folder("input.txt"), "new");
}

// Files of other results are refused by name, whether or not they exist, except for the command that makes them.
TEST_F(InputGuards, FilesOfOtherResultsAreNotWritten) {
  fs::create_directories(in_folder("run/jobs"));
  std::ofstream(in_folder("run/marker")) << "marker";
  fs::create_symlink("run/list", in_folder("link"));
  InputGuard const guard({{"study", {"marker", "jobs"}, {"list", "jobs/*"}}});
  for (std::string const name : {"run/list", "link", "run/jobs/../list", "run/jobs/1"}) {
    EXPECT_THAT([&] { OutputFile(in_folder(name)); }, ThrowsOutputError(name));
    EXPECT_FALSE(fs::exists(in_folder(name))) << name;
  }
  OutputFile::write_text(in_folder("run/other"), "new");
  OutputFile::write_text(in_folder("list"), "new");
  {
    ProtectedWritePermit const own;
    OutputFile::write_text(in_folder("run/list"), "own");
  }
  EXPECT_EQ(content(in_folder("run/list")), "own");
  fs::remove(in_folder("run/marker"));
  OutputFile::write_text(in_folder("run/list"), "new");
}

/// Fixture: kinds of the files of a case and of a study, determined from their content.
class FileKinds : public Output {
 protected:
  std::string kind(std::string const& name) const { return file_kind(in_folder(name)); }
};

TEST_F(FileKinds, AreToldByContent) {
  Hdf5Writer(in_folder("a.h5"), {"gladstone truth", 2, "", 0, "cpu"}).close();
  EXPECT_EQ(kind("a.h5"), "gladstone truth");
  write("damaged.h5", "\x89HDF\r\n\x1a\n and no more");
  EXPECT_EQ(kind("damaged.h5"), "damaged HDF5");
  write("figure.svg", "<?xml version=\"1.0\"?>\n<!-- a figure -->\n<svg>");
  EXPECT_EQ(kind("figure.svg"), "SVG");
  write("field.vti", "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">");
  EXPECT_EQ(kind("field.vti"), "VTK");
  write("field.vtk", "# vtk DataFile Version 3.0\n");
  EXPECT_EQ(kind("field.vtk"), "VTK");
  write("other.xml", "<?xml version=\"1.0\"?>\n<table>");
  EXPECT_EQ(kind("other.xml"), "XML");
  write("field.nrrd", "NRRD0005\n");
  EXPECT_EQ(kind("field.nrrd"), "NRRD");
  write("a.tif", std::string("II*\0....", 8));
  EXPECT_EQ(kind("a.tif"), "TIFF");
  write("manifest.jsonl", "{\"manifest\":3}\n{}\n");
  EXPECT_EQ(kind("manifest.jsonl"), "JSON");
  write("vectors.csv", "x_px,y_px,u_px,v_px,sigma_u_px\n");
  EXPECT_EQ(kind("vectors.csv"), "gladstone vectors");
  write("setup.toml", "# of a case\n\nschema = 1\n");
  EXPECT_EQ(kind("setup.toml"), "TOML");
  write("table.toml", "  [lens]\nf_number = 8\n");
  EXPECT_EQ(kind("table.toml"), "TOML");
  write("prose.toml", "# a heading\nWords, and no keys = values.\n");
  EXPECT_EQ(kind("prose.toml"), "");
  write("rays.csv", "status,x_mm,y_mm,z_mm,dx,dy,dz,opl_mm,col_px,row_px\nalive,0\n");
  EXPECT_EQ(kind("rays.csv"), "gladstone rays");
  write("study.csv", "lens.f_number,case,seed,status,repeat,rms_px\n8,0,1,ok,0,0.1\n");
  EXPECT_EQ(kind("study.csv"), "gladstone study table");
  write("study_points.csv", "lens.f_number,case,rms_px.mean,rms_px.std\n8,0,1,2\n");
  EXPECT_EQ(kind("study_points.csv"), "gladstone study points");
  write("benchmark.csv", "estimator,case,rms_px,seconds\n");
  EXPECT_EQ(kind("benchmark.csv"), "gladstone benchmark");
  write("combination.csv", "term,coefficient\nconstant,0.1\n");
  EXPECT_EQ(kind("combination.csv"), "gladstone uncertainty combination");
  write("mine.csv", "case,x,y,u,v\n1,2,3,4,5\n");
  EXPECT_EQ(kind("mine.csv"), "") << "a table of the user";
  write("report.md", "# What it shows\n\nText.\n");
  EXPECT_EQ(kind("report.md"), "Markdown");
  write("openpiv.txt", "# x y u v flags mask\n");
  EXPECT_EQ(kind("openpiv.txt"), "");
  write("report.html", "<!DOCTYPE html>\n<html>");
  EXPECT_EQ(kind("report.html"), "HTML");
  write("empty", "");
  EXPECT_EQ(kind("empty"), "");
  EXPECT_EQ(kind("absent"), "");
}

// An HTML report that would overwrite a truth file is refused, even if the truth file has not been read.
TEST_F(FileKinds, AnOutputOfAnotherKindDestroysNoResult) {
  Hdf5Writer(in_folder("truth.h5"), {"gladstone truth", 2, "", 0, "cpu"}).close();
  std::string const before = content(in_folder("truth.h5"));
  auto const refused = ThrowsOutputError("truth.h5");
  EXPECT_THAT([&] { OutputFile(in_folder("truth.h5"), "HTML"); }, refused) << "refused before any computation";
  EXPECT_THAT([&] { OutputFile::write_text(in_folder("truth.h5"), "<html>"); }, refused);
  EXPECT_THAT([&] { OutputFile::write_text(in_folder("truth.h5"), "# Markdown"); }, refused);
  EXPECT_THAT([&] { Hdf5Writer(in_folder("truth.h5"), {"gladstone vectors", 1, "", 0, "cpu"}); }, refused);
  EXPECT_EQ(content(in_folder("truth.h5")), before);
  Hdf5Writer(in_folder("truth.h5"), {"gladstone truth", 2, "other", 0, "cpu"}).close();
  write("damaged.h5", "\x89HDF\r\n\x1a\n and no more");
  EXPECT_THAT([&] { OutputFile::write_text(in_folder("damaged.h5"), "<html>"); }, ThrowsOutputError("damaged.h5"));
  write("study.csv", "case,seed,status,repeat\n");
  EXPECT_THAT([&] { OutputFile::write_text(in_folder("study.csv"), "x_px,y_px,u_px,v_px\n"); },
              ThrowsOutputError("study.csv"));
  EXPECT_THAT([&] { OutputFile::write_text(in_folder("study.csv"), "plain text"); }, ThrowsOutputError("study.csv"));
  OutputFile::write_text(in_folder("study.csv"), "case,seed,status,repeat\n0,1,ok,0\n");
  write("notes.txt", "mine");
  OutputFile::write_text(in_folder("notes.txt"), "<html>");  // named by the user, and of an unknown kind
}

}  // namespace
}  // namespace gladstone
