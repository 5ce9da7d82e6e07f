#include "relumbre/base/npy.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/base/temporary_folder.h"

namespace relumbre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A version 1 file with this header text, followed by `data`.
std::string npy(std::string dict, std::string_view data, char version = 1) {
  dict += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += {version, 0, static_cast<char>(dict.size()), static_cast<char>(dict.size() >> 8)};
  if (version > 1) bytes += {0, 0};
  return bytes + dict + std::string(data);
}

std::string header(const std::string& descr, const std::string& fortran, const std::string& shape) {
  return "{'descr': '" + descr + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }";
}

template <class T>
std::string bytes_of(std::initializer_list<T> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(T)};
}

void expect_refused(const std::string& bytes, const std::string& reason) {
  EXPECT_THAT([&] { (void)parse_npy(bytes, "bad.npy"); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("bad.npy: "), HasSubstr(reason))));
}

TEST(Npy, RoundTripKeepsShapeAndBits) {
  const TemporaryFolder folder;
  const float inf = std::numeric_limits<float>::infinity();
  for (const std::vector<std::size_t>& shape :
       {std::vector<std::size_t>{6}, {2, 3}, {1, 2, 3}, {3, 2, 1, 1}}) {
    const std::vector<float> data = {0, -1.5F, inf, 1e-40F, 3.4e38F, 7};
    write_npy(folder / "a.npy", shape, data);
    const FloatArray read = read_npy(folder / "a.npy");
    EXPECT_EQ(read.shape, shape);
    EXPECT_EQ(read.data, data);
  }
}

TEST(Npy, EmptyArraysAndScalarsRoundTrip) {
  const TemporaryFolder folder;
  const std::vector<std::size_t> empty = {0, 3};
  write_npy(folder / "a.npy", empty, {});
  EXPECT_EQ(read_npy(folder / "a.npy").shape, empty);
  const std::vector<float> one = {5};
  write_npy(folder / "a.npy", {}, one);
  EXPECT_TRUE(read_npy(folder / "a.npy").shape.empty());
  EXPECT_EQ(read_npy(folder / "a.npy").data, one);
}

TEST(Npy, HeaderEndsOnAMultipleOf64AsNumpyWritesIt) {
  const TemporaryFolder folder;
  for (std::size_t n = 1; n < 2000; n = n * 3 + 1) {
    write_npy(folder / "a.npy", std::vector<std::size_t>{n}, std::vector<float>(n));
    EXPECT_EQ((read_file(folder / "a.npy").size() - 4 * n) % 64, 0);
  }
}

TEST(Npy, DoublesAreConverted) {
  const FloatArray a =
      parse_npy(npy(header("<f8", "False", "(3,)"), bytes_of<double>({0.5, -2, 1e300})), "a");
  EXPECT_EQ(a.data[0], 0.5F);
  EXPECT_EQ(a.data[1], -2);
  EXPECT_TRUE(std::isinf(a.data[2]));
}

TEST(Npy, Versions1To3AreRead) {
  for (const char version : {char{1}, char{2}, char{3}}) {
    const std::string bytes =
        npy(header("<f4", "False", "(1, 2)"), bytes_of<float>({1, 2}), version);
    EXPECT_EQ(parse_npy(bytes, "a").data, (std::vector<float>{1, 2}));
  }
  expect_refused(npy(header("<f4", "False", "(1,)"), bytes_of<float>({1}), 4), "version");
}

TEST(Npy, RefusesWhatItCannotHold) {
  const std::string two = bytes_of<float>({1, 2});
  expect_refused("", "not a NumPy");
  expect_refused("\x93NUMPY", "not a NumPy");
  expect_refused(std::string(1000, 'x'), "not a NumPy");
  expect_refused(npy(header("<i4", "False", "(2,)"), two), "float32 or float64");
  expect_refused(npy(header(">f4", "False", "(2,)"), two), "float32 or float64");
  expect_refused(npy(header("\n\n\n", "False", "(2,)"), two), "not '???");
  expect_refused(npy(header("<f4", "True", "(2,)"), two), "Fortran");
  expect_refused(npy(header("<f4", "False", "(3,)"), two), "truncated");
  expect_refused(npy(header("<f4", "False", "(-2,)"), two), "not made of sizes");
  expect_refused(npy(header("<f4", "False", "2"), two), "shape tuple");
  expect_refused(npy("{'descr': '<f4'}", two), "'fortran_order'");
  expect_refused(npy("{}", two), "'descr'");
}

TEST(Npy, AbsurdShapesAreRefusedBeforeAllocating) {
  const std::string two = bytes_of<float>({1, 2});
  for (const char* shape : {"(1099511627776,)", "(4294967296, 4294967296)",
                            "(99999999999999999999999999,)", "(2, 9223372036854775808, 2)"}) {
    EXPECT_THROW((void)parse_npy(npy(header("<f4", "False", shape), two), "a"), FileError) << shape;
  }
}

TEST(Npy, EveryTruncationIsRefused) {
  const std::string whole = npy(header("<f4", "False", "(2, 3)"), std::string(24, '\1'));
  EXPECT_EQ(parse_npy(whole, "a").data.size(), 6);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW((void)parse_npy(std::string_view(whole).substr(0, size), "a"), FileError) << size;
  }
}

TEST(Npy, FlippedBytesGiveAnArrayOrAnError) {
  const std::string whole = npy(header("<f4", "False", "(2, 3)"), std::string(24, '\1'));
  RandomStream random(1);
  for (int i = 0; i < 20000; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 1 + i % 3; ++k) {
      bytes[random.bits() % bytes.size()] = static_cast<char>(random.bits());
    }
    try {
      const FloatArray a = parse_npy(bytes, "a");
      std::size_t count = 1;
      for (const std::size_t extent : a.shape) count *= extent;
      EXPECT_EQ(a.data.size(), count);
    } catch (const FileError&) {
    }
  }
}

TEST(Npy, WriteChecksTheShape) {
  const TemporaryFolder folder;
  const std::vector<float> data(5);
  EXPECT_THROW(write_npy(folder / "a.npy", std::vector<std::size_t>{2, 3}, data), ShapeError);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.npy"));
}

}  // namespace
}  // namespace relumbre
