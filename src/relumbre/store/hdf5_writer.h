/// Writing arrays, texts and attributes to a new HDF5 file.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "relumbre/store/stored_as.h"

namespace relumbre {

/// Writes a new file of HDF5's 1.10 format, which carries checksums on all its structures. Arrays
/// are chunked, shuffled, deflated (level 1) and followed by Fletcher-32 checksums. Paths are
/// "group/array"; the group must have been made before. Everything throws FileError naming the
/// target. Holds Hdf5Session's lock.
class Hdf5Writer {
 public:
  /// `user_block` bytes (0, or a power of two from 512) stay free at the front.
  Hdf5Writer(const std::filesystem::path& target, std::size_t user_block);
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  template <class T>
  void write(const std::string& path, std::span<const T> rows) {
    write_array(path, StoredAs<T>::kNumber, extent_of<T>(rows.size()), rows.data());
  }
  void write_array(const std::string& path, Number number, const Extent& extent, const void* data);
  /// A group with nothing in it yet.
  void make_group(const std::string& path);
  /// A scalar string of UTF-8.
  void write_text(const std::string& path, std::string_view text);
  void attribute(const std::string& group, const std::string& name, Number number,
                 const void* value);
  template <class T>
  void attribute(const std::string& group, const std::string& name, const T& value) {
    attribute(group, name, StoredAs<T>::kNumber, &value);
  }
  void text_attribute(const std::string& group, const std::string& name, std::string_view text);

  /// A one-dimensional array of `size` numbers that is filled piece by piece, in order.
  class Column {
   public:
    ~Column();
    Column(Column&&) noexcept;
    void append(std::span<const std::uint32_t> values);
    /// Writes what is left. Throws ShapeError unless exactly `size` values were appended.
    void finish();

   private:
    friend class Hdf5Writer;
    struct State;
    explicit Column(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
  };
  /// `number` is kU16 or kU32; values must fit.
  Column column(const std::string& path, Number number, std::uint64_t size);

  /// Closes the HDF5 file; nothing can be written to it after this.
  void close();
  /// The file, open for reading and writing, after close().
  [[nodiscard]] int descriptor() const;
  /// Renames the closed file into place. Without it nothing is left behind.
  void commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace relumbre
