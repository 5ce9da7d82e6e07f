/// Reading arrays, texts and attributes of an HDF5 file.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relumbre/store/stored_as.h"

namespace relumbre {

/// Reads files that may be hostile: types and extents are checked before anything is allocated.
/// Everything throws FileError naming the file and the array.
/// Holds Hdf5Session's lock.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::filesystem::path& file);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  [[nodiscard]] bool has(const std::string& path) const;
  /// Extent of an array. Refuses arrays that could not come out of a file of this size: deflate
  /// expands at most 1,032 times.
  [[nodiscard]] Extent extent(const std::string& path) const;
  /// Rows of an array of T; refuses other widths.
  template <class T>
  [[nodiscard]] std::uint64_t rows(const std::string& path) const {
    return checked_rows(path, StoredAs<T>::kWidth);
  }
  /// The whole array. It must have `rows` rows.
  template <class T>
  [[nodiscard]] std::vector<T> read(const std::string& path, std::uint64_t rows) const {
    require_extent(path, extent_of<T>(rows));
    std::vector<T> values(rows);
    read_array(path, StoredAs<T>::kNumber, values.data());
    return values;
  }
  /// Reads an array of exactly that extent into `data`.
  void require_extent(const std::string& path, const Extent& expected) const;
  void read_array(const std::string& path, Number number, void* data) const;
  [[nodiscard]] std::string text(const std::string& path) const;

  [[nodiscard]] std::string text_attribute(const std::string& group, const std::string& name) const;
  template <class T>
  [[nodiscard]] T attribute(const std::string& group, const std::string& name) const {
    T value{};
    read_attribute(group, name, StoredAs<T>::kNumber, &value);
    return value;
  }

 private:
  void read_attribute(const std::string& group, const std::string& name, Number number,
                      void* value) const;
  [[nodiscard]] std::uint64_t checked_rows(const std::string& path, std::uint64_t width) const;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace relumbre
