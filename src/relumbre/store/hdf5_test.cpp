#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "relumbre/base/temporary_folder.h"
#include "relumbre/store/hdf5_reader.h"
#include "relumbre/store/hdf5_session.h"
#include "relumbre/store/hdf5_writer.h"
#include "relumbre/store/test_support.h"

namespace relumbre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Hdf5 : public testing::Test {
 protected:
  /// Writes with the library itself what Hdf5Writer never would.
  template <class Make>
  void make(Make&& make) {
    const Hdf5Session session;
    const Hdf5Handle file(H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                          H5Fclose);
    make(file.get());
  }
  template <class Read>
  std::string refusal(Read&& read) {
    return file_error([&] { read(Hdf5Reader(path_)); });
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_ / "a.h5";
};

void make_array(hid_t file, const char* name, hid_t type, hsize_t size, hid_t properties) {
  const Hdf5Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const Hdf5Handle dataset(
      H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
}

TEST_F(Hdf5, ColumnsWrittenInPiecesOfAnySizeReadBack) {
  constexpr std::uint32_t kSize = 600011;  // more than two chunks
  std::vector<std::uint32_t> values(kSize);
  for (std::uint32_t i = 0; i < kSize; ++i) values[i] = i % 65521;
  Hdf5Writer out(path_, 0);
  Hdf5Writer::Column column = out.column("a", Number::kU16, kSize);
  for (std::size_t at = 0, piece = 1; at < kSize; at += piece, piece = piece * 5 % 300007 + 1) {
    column.append(std::span(values).subspan(at).first(std::min<std::size_t>(piece, kSize - at)));
  }
  column.finish();
  out.close();
  out.commit();
  EXPECT_EQ(Hdf5Reader(path_).read<std::uint32_t>("a", kSize), values);
}

TEST_F(Hdf5, ColumnsMustBeFilledExactly) {
  Hdf5Writer out(path_, 0);
  Hdf5Writer::Column column = out.column("a", Number::kU32, 3);
  const std::vector<std::uint32_t> two{1, 2};
  column.append(two);
  EXPECT_THROW(column.append(two), ShapeError);
  EXPECT_THROW(column.finish(), ShapeError);
}

TEST_F(Hdf5, RefusesExtentsThatTheFileCannotHold) {
  make([](hid_t file) {
    const Hdf5Handle chunked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const hsize_t chunk = 1024;
    H5Pset_chunk(chunked.get(), 1, &chunk);
    make_array(file, "a", H5T_STD_U32LE, hsize_t{1} << 40, chunked.get());
  });
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.rows<std::uint32_t>("a"); }),
              HasSubstr("more than the file can hold"));
}

TEST_F(Hdf5, RefusesOtherShapesAndTypes) {
  make([](hid_t file) {
    make_array(file, "float", H5T_IEEE_F64LE, 4, H5P_DEFAULT);
    const Hdf5Handle early(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_alloc_time(early.get(), H5D_ALLOC_TIME_EARLY);
    make_array(file, "long", H5T_STD_U64LE, 4, early.get());
    make_array(file, "signed", H5T_STD_I32LE, 4, early.get());
  });
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.read<std::uint32_t>("none", 4); }),
              HasSubstr("none is missing"));
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.read<std::uint64_t>("long", 5); }),
              HasSubstr("has shape (4), expected (5)"));
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.rows<Vec3f>("long"); }),
              HasSubstr("not rows of 3"));
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.read<std::uint32_t>("long", 4); }),
              HasSubstr("another number type"));
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.read<std::uint32_t>("signed", 4); }),
              HasSubstr("another number type"));
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.read<float>("long", 4); }),
              HasSubstr("another number type"));
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.text("long"); }),
              HasSubstr("is not a text"));
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.text_attribute("/", "x"); }),
              HasSubstr("is missing"));
}

TEST_F(Hdf5, ChecksumsFindEveryFlippedByteOfAnArray) {
  std::vector<std::uint32_t> values(5000);
  for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = i * i;
  Hdf5Writer out(path_, 0);
  out.write<std::uint32_t>("a", values);
  out.close();
  out.commit();
  haddr_t begin = 0;
  hsize_t size = 0;
  {
    const Hdf5Session session;
    const Hdf5Handle file(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    const Hdf5Handle array(H5Dopen2(file.get(), "a", H5P_DEFAULT), H5Dclose);
    const Hdf5Handle space(H5Dget_space(array.get()), H5Sclose);
    H5Dget_chunk_info(array.get(), space.get(), 0, nullptr, nullptr, &begin, &size);
  }
  const std::string bytes = bytes_of(path_);
  ASSERT_GT(size, 1000U);
  for (std::size_t i = begin; i < begin + size; i += 97) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    put_bytes(path_, damaged);
    EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.read<std::uint32_t>("a", 5000); }),
                HasSubstr("a is damaged"));
  }
}

TEST_F(Hdf5, NeverReadsOtherFiles) {
  const fs::path secret = folder_ / "secret";
  put_bytes(secret, std::string(64, 's'));
  make([&](hid_t file) {
    const Hdf5Handle outside(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_external(outside.get(), secret.c_str(), 0, 16);
    make_array(file, "outside", H5T_STD_U32LE, 4, outside.get());
    make_array(file, "inside", H5T_STD_U32LE, 4, H5P_DEFAULT);
    H5Lcreate_external("b.h5", "inside", file, "link", H5P_DEFAULT, H5P_DEFAULT);
  });
  fs::copy_file(path_, folder_ / "b.h5");
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.extent("outside"); }),
              HasSubstr("is not stored in this file"));
  EXPECT_THAT(refusal([](const Hdf5Reader& in) { (void)in.extent("link"); }),
              HasSubstr("is not stored in this file"));
}

TEST_F(Hdf5, PutsTheCallersErrorPrintingBack) {
  H5E_auto2_t before = nullptr, after = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &before, &data);
  (void)refusal([](const Hdf5Reader&) {});
  H5Eget_auto2(H5E_DEFAULT, &after, &data);
  EXPECT_NE(before, nullptr);
  EXPECT_EQ(before, after);
}

}  // namespace
}  // namespace relumbre
