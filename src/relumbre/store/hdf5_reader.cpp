#include "relumbre/store/hdf5_reader.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "relumbre/base/error.h"
#include "relumbre/store/descriptor.h"
#include "relumbre/store/hdf5_session.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kDeflateExpansion = 1032;  // of zlib's own documentation
constexpr std::size_t kMaxAttributeText = 65536;

/// a · b, or the largest number where that overflows.
std::uint64_t saturating_product(std::uint64_t a, std::uint64_t b) {
  std::uint64_t product = 0;
  return __builtin_mul_overflow(a, b, &product) ? ~std::uint64_t{0} : product;
}

bool is_float(Number number) { return number == Number::kF32 || number == Number::kF64; }

/// Numbers of that kind that fit without loss.
bool fits(hid_t stored, Number number) {
  const H5T_class_t kind = is_float(number) ? H5T_FLOAT : H5T_INTEGER;
  return H5Tget_class(stored) == kind && H5Tget_size(stored) <= size_of(number) &&
         (is_float(number) || (H5Tget_sign(stored) == H5T_SGN_2) == (number == Number::kI32));
}

}  // namespace

struct Hdf5Reader::Impl {
  fs::path path;
  std::uint64_t bytes;
  Hdf5Session session;
  Hdf5Handle handle;

  [[noreturn]] void fail(const std::string& what, const std::string& reason) const {
    throw FileError(path.string(), what + " " + reason);
  }
  [[nodiscard]] Hdf5Handle open(const std::string& array) const;
  [[nodiscard]] Hdf5Handle open_attribute(const std::string& group, const std::string& name) const;
};

/// Only arrays that lie in this file: no links to, and no data in, other files.
Hdf5Handle Hdf5Reader::Impl::open(const std::string& array) const {
  Hdf5Handle dataset(H5Dopen2(handle.get(), array.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.valid()) fail(array, "is missing or damaged" + hdf5_reason());
  const Hdf5Handle properties(H5Dget_create_plist(dataset.get()), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(properties.get());
  const std::string own = path.string();
  std::string owner(own.size() + 1, '\0');
  const bool here = H5Fget_name(dataset.get(), owner.data(), owner.size() + 1) ==
                        static_cast<ssize_t>(own.size()) &&
                    owner.compare(0, own.size(), own) == 0;
  if (!here || H5Pget_external_count(properties.get()) != 0 ||
      (layout != H5D_CHUNKED && layout != H5D_CONTIGUOUS)) {
    fail(array, "is not stored in this file");
  }
  return dataset;
}

Hdf5Handle Hdf5Reader::Impl::open_attribute(const std::string& group,
                                            const std::string& name) const {
  Hdf5Handle attribute(
      H5Aopen_by_name(handle.get(), group.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  const std::string what = group + " attribute " + name;
  if (!attribute.valid()) fail(what, "is missing or damaged" + hdf5_reason());
  const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.get()) != 1) fail(what, "is not a single value");
  return attribute;
}

Hdf5Reader::Hdf5Reader(const fs::path& file)
    : impl_(new Impl{file, file_length(open_for_reading(file).get(), file), {}, {}}) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  H5Pset_file_locking(access.get(), 0, 1);  // finished stores are never written to again
  impl_->handle = Hdf5Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!impl_->handle.valid()) {
    throw FileError(file.string(), "cannot be read" + hdf5_reason());
  }
}

Hdf5Reader::~Hdf5Reader() = default;

bool Hdf5Reader::has(const std::string& path) const {
  return H5Lexists(impl_->handle.get(), path.c_str(), H5P_DEFAULT) > 0;
}

Extent Hdf5Reader::extent(const std::string& path) const {
  const Hdf5Handle dataset = impl_->open(path);
  const Hdf5Handle space(H5Dget_space(dataset.get()), H5Sclose);
  const Hdf5Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1 || rank > 4) impl_->fail(path, "is not an array");
  std::vector<hsize_t> sides(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), sides.data(), nullptr);
  std::uint64_t bytes = H5Tget_size(type.get());
  for (const hsize_t side : sides) bytes = saturating_product(bytes, side);
  const std::uint64_t stored =
      std::min<std::uint64_t>(H5Dget_storage_size(dataset.get()), impl_->bytes);
  if (bytes > saturating_product(stored, kDeflateExpansion)) {
    impl_->fail(path, fmt::format("claims {} bytes, more than the file can hold", bytes));
  }
  return {sides.begin(), sides.end()};
}

std::uint64_t Hdf5Reader::checked_rows(const std::string& path, std::uint64_t width) const {
  const Extent found = extent(path);
  const std::uint64_t found_width = found.size() == 1 ? 1 : found[1];
  if (found.size() > 2 || (found.size() == 1) != (width == 1) || found_width != width) {
    impl_->fail(path, fmt::format("has shape ({}), not rows of {}", fmt::join(found, ", "), width));
  }
  return found[0];
}

void Hdf5Reader::require_extent(const std::string& path, const Extent& expected) const {
  const Extent found = extent(path);
  if (found == expected) return;
  impl_->fail(path, fmt::format("has shape ({}), expected ({})", fmt::join(found, ", "),
                                fmt::join(expected, ", ")));
}

void Hdf5Reader::read_array(const std::string& path, Number number, void* data) const {
  const Hdf5Handle dataset = impl_->open(path);
  const Hdf5Handle type(H5Dget_type(dataset.get()), H5Tclose);
  if (!fits(type.get(), number)) impl_->fail(path, "has another number type");
  if (H5Dread(dataset.get(), memory_type(number), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    impl_->fail(path, "is damaged" + hdf5_reason());
  }
}

std::string Hdf5Reader::text(const std::string& path) const {
  const Hdf5Handle dataset = impl_->open(path);
  const Hdf5Handle space(H5Dget_space(dataset.get()), H5Sclose);
  const Hdf5Handle type(H5Dget_type(dataset.get()), H5Tclose);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 ||
      H5Sget_simple_extent_npoints(space.get()) != 1 ||
      H5Tget_size(type.get()) >
          std::min<std::uint64_t>(H5Dget_storage_size(dataset.get()), impl_->bytes)) {
    impl_->fail(path, "is not a text");
  }
  std::string text(H5Tget_size(type.get()), '\0');
  if (H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) {
    impl_->fail(path, "is damaged" + hdf5_reason());
  }
  return text;
}

std::string Hdf5Reader::text_attribute(const std::string& group, const std::string& name) const {
  const Hdf5Handle attribute = impl_->open_attribute(group, name);
  const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
  std::string text(std::min(H5Tget_size(type.get()), kMaxAttributeText), '\0');
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 ||
      H5Tget_size(type.get()) > kMaxAttributeText ||
      H5Aread(attribute.get(), type.get(), text.data()) < 0) {
    impl_->fail(group + " attribute " + name, "is not a text");
  }
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

void Hdf5Reader::read_attribute(const std::string& group, const std::string& name, Number number,
                                void* value) const {
  const Hdf5Handle attribute = impl_->open_attribute(group, name);
  const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
  if (!fits(type.get(), number) || H5Aread(attribute.get(), memory_type(number), value) < 0) {
    impl_->fail(group + " attribute " + name, "is not a number of the right type");
  }
}

}  // namespace relumbre
