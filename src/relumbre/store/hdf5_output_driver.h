/// An HDF5 file driver for writing a new file, whose writes never fail halfway.
///
/// Where a write fails (a full disk), HDF5 1.10 cannot close the file any more and crashes when the
/// process ends. This driver remembers the first failure, drops what follows, and lets HDF5 close
/// in peace; the writer of the file looks at error() and throws.
#pragma once

#include <cstdint>

#include "relumbre/store/descriptor.h"

namespace relumbre {

/// HDF5's hid_t, so that no other header needs HDF5's.
using Hdf5Id = std::int64_t;

/// The file that the driver writes to, and what became of it.
class OutputSink {
 public:
  explicit OutputSink(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}
  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  /// errno of the first failure, 0 if there was none.
  [[nodiscard]] int error() const { return error_; }

  void write(std::uint64_t offset, std::span<const std::byte> bytes);
  void resize(std::uint64_t length);
  /// Bytes that were never written read as zero.
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  Descriptor descriptor_;
  int error_ = 0;
};

/// Makes files that are created with the file-access properties `access` go to `sink`, which must
/// outlive them. Returns the driver's id, to be given to H5FDunregister; negative on failure.
Hdf5Id use_output_driver(Hdf5Id access, OutputSink& sink);

}  // namespace relumbre
